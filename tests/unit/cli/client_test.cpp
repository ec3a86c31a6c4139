#include "cli/client.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/asio/write.hpp>
#include <thread>

#include "cli/status_document.hpp"
#include "daemon/api/server.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/cli/sample_status.hpp"

namespace thimble::cli {
namespace {

using testing::HasSubstr;

class FakeDaemon : public api::StatusView, public api::Commands {
 public:
  [[nodiscard]] api::Status status() const override { return sample_status(); }
  void activate(std::string_view, api::ClientId, api::Answer answer) override {
    answer(api::Done{"active", ""});
  }
  void deactivate(std::string_view, api::ClientId, api::Answer answer) override {
    answer(api::Done{"inactive", ""});
  }
  void clear_fault(std::string_view, std::optional<std::uint32_t>, api::ClientId,
                   api::Answer answer) override {
    answer(fail(Errc::Busy, "the stop is still pressed"));
  }
  void steady_force(std::string_view, std::optional<double>, api::ClientId,
                    api::Answer answer) override {
    answer(api::Done{"active", ""});
  }
  void set_impedance(std::string_view, double, api::Answer answer) override {
    answer(api::Done{"active", ""});
  }
  void edit_world(std::string_view, const std::vector<api::CellEdit>&, api::ClientId,
                  api::EditAnswer) override {}
  void ask_world(std::string_view, api::HandVerb, api::Answer answer) override {
    answer(api::Done{"active", ""});
  }
  void act_on_pieces(std::string_view, api::PieceVerb, api::ClientId, api::PieceAnswer) override {}
  void read_cells(std::string_view, api::ClientId, api::FileAnswer answer) override {
    answer(std::string("NRRD{}\n"));
  }
  void save_world(std::string_view, api::ClientId, api::FileAnswer answer) override {
    answer(fail(Errc::Unsupported, "nothing runs here"));
  }
  void load_world(std::string_view, std::string, api::ClientId, api::LoadAnswer answer) override {
    answer(fail(Errc::Unsupported, "nothing runs here"));
  }
  void client_gone(api::ClientId) override {}
};

class ClientTest : public testing::Test {
 protected:
  void SetUp() override {
    auto server = api::Server::create(context_, {path_, 0600, ""}, daemon_, daemon_);
    ASSERT_TRUE(server);
    server_ = std::move(*server);
    thread_ = std::thread([this] { context_.run(); });
  }
  void TearDown() override { stop(); }
  void stop() {
    if (!thread_.joinable()) return;
    boost::asio::post(context_, [this] { server_.reset(); });
    thread_.join();
  }

  testing_support::TemporaryFolder folder_;
  std::string path_{(folder_ / "t.sock").string()};
  boost::asio::io_context context_;
  FakeDaemon daemon_;
  std::unique_ptr<api::Server> server_;
  std::thread thread_;
};

TEST_F(ClientTest, AsksOverAndOverOnOneConnection) {
  const auto sut = Client::connect(path_);
  ASSERT_TRUE(sut) << sut.error().message;
  for (int i = 0; i < 3; ++i) {
    const auto reply = (*sut)->request("GET", "/v1/status");
    ASSERT_TRUE(reply) << reply.error().message;
    EXPECT_EQ(reply->http_status, 200U);
    EXPECT_EQ(*parse_status(reply->body), sample_status());
  }
}

TEST_F(ClientTest, BringsTheSentenceOfARefusal) {
  const auto sut = Client::connect(path_);
  const auto reply = (*sut)->request("POST", "/v1/arms/right/clear-fault");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->http_status, 409U);
  EXPECT_EQ(parse_error_message(reply->body, ""), "the stop is still pressed");
}

TEST_F(ClientTest, AsksNobodyInAPlaceThatAStrangerMayHaveTaken) {
  ASSERT_EQ(::chmod(folder_.path().c_str(), 01777), 0);
  EXPECT_TRUE(Client::connect(path_)) << "the socket is the caller's own";
  const auto missing = Client::connect(folder_ / "none.sock");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, Errc::NotFound);
  EXPECT_THAT(missing.error().message, HasSubstr("no daemon is running at"));
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a socket to somebody else";
  ASSERT_EQ(::chown(path_.c_str(), 1001, 1001), 0);
  const auto theirs = Client::connect(path_);
  ASSERT_FALSE(theirs);
  EXPECT_EQ(theirs.error().code, Errc::Permission);
  EXPECT_THAT(theirs.error().message, HasSubstr(path_ + " belongs to another user"));
}

TEST_F(ClientTest, NoticesTheEndOfTheDaemon) {
  const auto sut = Client::connect(path_);
  ASSERT_TRUE((*sut)->request("GET", "/v1/status"));
  stop();
  const auto reply = (*sut)->request("GET", "/v1/status");
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.error().code, Errc::Disconnected);
}

TEST(Client, SaysInOneSentenceThatNoDaemonRuns) {
  const testing_support::TemporaryFolder folder;
  const auto sut = Client::connect((folder / "none.sock").string());
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::NotFound);
  EXPECT_THAT(sut.error().message, HasSubstr("no daemon is running at"));
  EXPECT_FALSE(Client::connect(std::string(300, 'x')));
}

TEST(Client, LetsNoControlBytesOfAPathThrough) {
  for (const std::string& path :
       {"/none/\x1b[31m" + std::string(9, 'x'), std::string(300, '\x1b')}) {
    const auto sut = Client::connect(path);
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().message.find('\x1b'), std::string::npos);
  }
}

TEST(Client, GivesUpOnADaemonThatDoesNotAccept) {
  using Local = boost::asio::local::stream_protocol;
  const testing_support::TemporaryFolder folder;
  const std::string path = (folder / "full.sock").string();
  boost::asio::io_context context;
  Local::acceptor listener(context);
  listener.open();
  listener.bind(Local::endpoint(path));
  listener.listen(0);
  // A backlog of none takes one.
  const auto first = Client::connect(path);
  ASSERT_TRUE(first) << first.error().message;

  const auto sut = Client::connect(path, std::chrono::milliseconds(1));
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::Timeout);
  EXPECT_THAT(sut.error().message, HasSubstr("does not accept"));
}

TEST(Client, KeepsNoMoreOfAnAnswerThanOneCouldNeed) {
  using Local = boost::asio::local::stream_protocol;
  const testing_support::TemporaryFolder folder;
  const std::string path = (folder / "endless.sock").string();
  boost::asio::io_context context;
  Local::acceptor listener(context, Local::endpoint(path));
  auto sut = Client::connect(path);
  ASSERT_TRUE(sut) << sut.error().message;
  std::thread daemon([&] {
    Local::socket peer = listener.accept();
    const std::string answer = "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n1;" +
                               std::string(std::size_t{1} << 22, 'x');
    boost::system::error_code gone;
    boost::asio::write(peer, boost::asio::buffer(answer), gone);
  });
  const auto reply = (*sut)->request("GET", "/v1/status");
  sut->reset();  // the daemon ends its writing
  daemon.join();
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.error().code, Errc::Malformed);
  EXPECT_THAT(reply.error().message, HasSubstr("not the daemon's"));
}

}  // namespace
}  // namespace thimble::cli
