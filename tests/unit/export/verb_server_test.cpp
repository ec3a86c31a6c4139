#include "sim/export/verb_server.hpp"

#include <gtest/gtest.h>

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <filesystem>
#include <fstream>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace thimble::sim {
namespace {

using Local = boost::asio::local::stream_protocol;

// Its client's calls are non-blocking, and the server runs between them.
class VerbServerTest : public ::testing::Test {
 protected:
  VerbServerTest() {
    auto server = VerbServer::listen(io_, path_, [this](std::string_view line) {
      asked_.emplace_back(line);
      return [pieces = std::vector<std::string>{"\n", std::string(line), "to "}]() mutable {
        const std::string piece = pieces.empty() ? "" : pieces.back();
        if (!pieces.empty()) pieces.pop_back();
        return piece;
      };
    });
    EXPECT_TRUE(server);
    sut_ = *std::move(server);
  }
  Local::socket connect() {
    Local::socket socket(io_);
    socket.connect(Local::endpoint(path_));
    socket.non_blocking(true);
    run();
    return socket;
  }
  void run() {
    for (int i = 0; i < 20; ++i) {
      io_.restart();
      io_.poll();
    }
  }
  void write(Local::socket& socket, std::string_view bytes) {
    boost::system::error_code ignored;
    boost::asio::write(socket, boost::asio::buffer(bytes), ignored);
    run();
  }
  std::string read(Local::socket& socket) {
    std::string bytes(4096, '\0');
    boost::system::error_code error;
    bytes.resize(socket.read_some(boost::asio::buffer(bytes), error));
    is_cut_off_ = error && error != boost::asio::error::would_block;
    return bytes;
  }

  testing_support::TemporaryFolder folder_;
  std::string path_ = (folder_ / "s").string();
  boost::asio::io_context io_;
  std::vector<std::string> asked_;
  std::unique_ptr<VerbServer> sut_;
  bool is_cut_off_{false};
};

TEST_F(VerbServerTest, AnswersLineByLineHoweverTheyCome) {
  Local::socket client = connect();
  write(client, "o");
  write(client, "ne\ntwo\nth");
  EXPECT_EQ(read(client), "to one\nto two\n");
  write(client, "ree\n");
  EXPECT_EQ(read(client), "to three\n");
}

TEST_F(VerbServerTest, HasSeveralClientsAtOnce) {
  Local::socket one = connect();
  Local::socket other = connect();
  write(other, "b\n");
  write(one, "a\n");
  EXPECT_EQ(read(one), "to a\n");
  EXPECT_EQ(read(other), "to b\n");
}

TEST_F(VerbServerTest, CutsOffWhoSendsWithoutEnd) {
  Local::socket client = connect();
  for (int i = 0; i < 10; ++i) write(client, std::string(100, 'x'));
  read(client);
  EXPECT_TRUE(is_cut_off_);
  EXPECT_TRUE(asked_.empty());
}

// Or who is there first, and says nothing, keeps everybody else out.
TEST_F(VerbServerTest, CutsOffWhoHasBeenStillForTheLongestTimeWhenThereAreTooMany) {
  std::vector<Local::socket> clients;
  for (std::size_t i = 0; i < VerbServer::kMostConnections; ++i) clients.push_back(connect());
  write(clients[0], "a\n");
  Local::socket late = connect();
  write(late, "b\n");
  EXPECT_EQ(read(late), "to b\n");
  EXPECT_EQ(read(clients[0]), "to a\n");
  EXPECT_FALSE(is_cut_off_);
  read(clients[1]);
  EXPECT_TRUE(is_cut_off_);
  for (std::size_t i = 2; i < clients.size(); ++i) {
    read(clients[i]);
    EXPECT_FALSE(is_cut_off_) << i;
  }
}

TEST_F(VerbServerTest, KeepsNoMoreThanItsMostHoweverManyCome) {
  std::vector<Local::socket> clients;
  for (std::size_t i = 0; i < 5 * VerbServer::kMostConnections; ++i) clients.push_back(connect());
  std::size_t kept = 0;
  for (Local::socket& client : clients) {
    read(client);
    if (!is_cut_off_) ++kept;
  }
  EXPECT_EQ(kept, VerbServer::kMostConnections);
}

TEST_F(VerbServerTest, TakesItsFileAlong) {
  EXPECT_TRUE(std::filesystem::is_socket(path_));
  Local::socket client = connect();
  sut_.reset();
  EXPECT_FALSE(std::filesystem::exists(path_));
  write(client, "a\n");
  EXPECT_TRUE(asked_.empty());
}

TEST_F(VerbServerTest, RefusesAPlaceThatIsTaken) {
  EXPECT_EQ(VerbServer::listen(io_, path_, {}).error().code, Errc::Busy);
  const std::string file = (folder_ / "file").string();
  std::ofstream(file) << "mine";
  for (const std::string& path : {file, folder_.path().string()}) {
    EXPECT_EQ(VerbServer::listen(io_, path, {}).error(),
              (Error{Errc::InvalidArgument, path + ": is there already, and is no socket"}));
  }
  EXPECT_EQ(std::filesystem::file_size(file), 4U);
  EXPECT_EQ(VerbServer::listen(io_, std::string(200, 'x'), {}).error().code, Errc::InvalidArgument);
}

TEST_F(VerbServerTest, ReplacesAFileThatNobodyListensAt) {
  const std::string stale = (folder_ / "stale").string();
  { Local::acceptor dead(io_, Local::endpoint(stale)); }
  ASSERT_TRUE(std::filesystem::is_socket(stale));
  EXPECT_TRUE(VerbServer::listen(io_, stale, {}));
}

}  // namespace
}  // namespace thimble::sim
