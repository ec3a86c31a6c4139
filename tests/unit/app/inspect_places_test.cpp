#include "daemon/app/inspect_places.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "daemon/api/socket_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::app {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class InspectPlaces : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> objections() const {
    std::vector<std::string> out;
    for (const auto& inspect : {inspect_socket, inspect_recordings}) {
      for (const config::Objection& objection : inspect(config_)) {
        EXPECT_EQ(objection.table, config::Objection::Table::Daemon);
        out.push_back(objection.key + ": " + objection.message);
      }
    }
    return out;
  }

  testing_support::TemporaryFolder folder_;
  config::Config config_;
};

TEST_F(InspectPlaces, ObjectToNothingThatAStartWouldTake) {
  EXPECT_THAT(objections(), IsEmpty());
  config_.daemon.socket = (folder_ / "thimble.sock").string();
  config_.daemon.group = "root";
  config_.daemon.flight_directory = (folder_ / "yet/to/be/made").string();
  EXPECT_THAT(objections(), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "yet"));
}

TEST_F(InspectPlaces, TellAllAtOnceByTheirKeys) {
  config_.daemon.socket = folder_.write("notes.txt", "mine").string();
  config_.daemon.group = "no-such-group";
  config_.daemon.flight_directory = (folder_.write("file", "x") / "below").string();
  EXPECT_THAT(
      objections(),
      ElementsAre(HasSubstr("socket: " + *config_.daemon.socket),
                  HasSubstr("group: there is no group \"no-such-group\""),
                  HasSubstr("flight_directory: " + (folder_ / "file").string() + " is no folder")));
}

// A typing error must not make a folder somewhere, which the daemon may do as root.
TEST_F(InspectPlaces, ObjectToASocketInAFolderThatIsNotThere) {
  config_.daemon.socket = (folder_ / "nope/thimble.sock").string();
  EXPECT_THAT(
      objections(),
      ElementsAre(AllOf(HasSubstr("socket: there is no folder " + (folder_ / "nope").string()),
                        HasSubstr("correct daemon.socket, or make the folder"))));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "nope"));
  std::filesystem::create_directory(folder_ / "nope");
  EXPECT_THAT(objections(), IsEmpty());
  config_.daemon.socket = (folder_.write("file", "x") / "thimble.sock").string();
  EXPECT_THAT(objections(), ElementsAre(HasSubstr("file is no folder for the socket")));
  config_.daemon.socket = "thimble.sock";
  EXPECT_THAT(objections(), IsEmpty()) << "where the daemon is started";
}

TEST_F(InspectPlaces, LeaveTheDefaultFoldersToTheStart) {
  config_.daemon.socket = "/run/thimble/other.sock";
  EXPECT_THAT(objections(), IsEmpty()) << "the service manager makes it";
  ASSERT_EQ(::setenv("THIMBLE_SOCKET", (folder_ / "own/thimble.sock").c_str(), 1), 0);
  config_.daemon.socket = (folder_ / "own/thimble.sock").string();
  EXPECT_THAT(objections(), IsEmpty());
  ::unsetenv("THIMBLE_SOCKET");
}

TEST_F(InspectPlaces, MeasureASocketsPath) {
  config_.daemon.socket = "/" + std::string(106, 's');
  EXPECT_THAT(objections(), IsEmpty());
  config_.daemon.socket = "/" + std::string(107, 's');
  EXPECT_THAT(objections(), ElementsAre(HasSubstr("1 to 107 bytes")));
  config_.daemon.socket = "";
  EXPECT_THAT(objections(), ElementsAre(HasSubstr("1 to 107 bytes")));
}

TEST_F(InspectPlaces, TakeAFolderThatIsThereAndALinkToOne) {
  std::filesystem::create_directory_symlink(folder_.path(), folder_ / "link");
  for (const auto& there : {folder_.path(), folder_ / "link", folder_ / "link" / "below"}) {
    config_.daemon.flight_directory = there.string();
    EXPECT_THAT(objections(), IsEmpty()) << there;
  }
}

// A daemon that runs there, or that did not live to remove it: the start tells them apart.
TEST_F(InspectPlaces, LeaveASocketToTheStart) {
  config_.daemon.socket = (folder_ / "thimble.sock").string();
  const auto running = api::SocketFile::create({*config_.daemon.socket, 0600, ""});
  ASSERT_TRUE(running);
  EXPECT_THAT(objections(), IsEmpty());
}

}  // namespace
}  // namespace thimble::app
