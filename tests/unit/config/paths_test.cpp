#include "daemon/config/paths.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <set>
#include <string>

#include "daemon/config/endpoint.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::config {
namespace {

TEST(DefaultSocketPath, TakesTheFirstOfItsSources) {
  Environment sut{{{"THIMBLE_SOCKET", "/a.sock"},
                   {"RUNTIME_DIRECTORY", "/run/thimble:/run/other"},
                   {"XDG_RUNTIME_DIR", "/run/user/7"}},
                  7};
  EXPECT_EQ(default_socket_path(sut), "/a.sock");
  sut.variables.erase("THIMBLE_SOCKET");
  EXPECT_EQ(default_socket_path(sut), "/run/thimble/thimble.sock");
  sut.variables["RUNTIME_DIRECTORY"] = "";
  EXPECT_EQ(default_socket_path(sut), "/run/user/7/thimble.sock");
  sut.variables.clear();
  EXPECT_EQ(default_socket_path(sut), "/tmp/thimble-7/thimble.sock");
  sut.user_id = 0;
  EXPECT_EQ(default_socket_path(sut), "/run/thimble/thimble.sock");
}

class ClientSocketPath : public ::testing::Test {
 protected:
  std::string path() {
    return client_socket_path(sut_,
                              [this](const std::string& path) { return there_.contains(path); });
  }

  Environment sut_{{{"XDG_RUNTIME_DIR", "/run/user/7"}}, 7};
  std::set<std::string> there_;
};

TEST_F(ClientSocketPath, IsTheDaemonsOwnWhereOneIs) {
  there_ = {"/run/user/7/thimble.sock", "/run/thimble"};
  EXPECT_EQ(path(), "/run/user/7/thimble.sock");
}

// The folder may be closed to this user: that there is a socket in it cannot be seen.
TEST_F(ClientSocketPath, IsTheServicesWhereNobodysDaemonRuns) {
  there_ = {"/run/thimble"};
  EXPECT_EQ(path(), "/run/thimble/thimble.sock");
}

TEST_F(ClientSocketPath, IsTheOwnWhereNothingRuns) {
  EXPECT_EQ(path(), "/run/user/7/thimble.sock");
}

// Anybody may make /tmp/thimble-UID before its user does.
TEST_F(ClientSocketPath, IsTheServicesWhereAStrangerTookTheOwn) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a folder to somebody else";
  const testing_support::TemporaryFolder folder;
  ASSERT_EQ(::chmod(folder.path().c_str(), 01777), 0);
  const std::string own = folder.write("thimble-7/thimble.sock", "");
  sut_.variables["XDG_RUNTIME_DIR"] = folder / "thimble-7";
  const auto chosen = [&] {
    return client_socket_path(sut_, [](const std::string& path) {
      return path == "/run/thimble" || is_there_and_no_strangers(path);
    });
  };
  EXPECT_EQ(chosen(), own);
  ASSERT_EQ(::chown((folder / "thimble-7").c_str(), 1001, 1001), 0);
  EXPECT_EQ(chosen(), "/run/thimble/thimble.sock");
}

TEST_F(ClientSocketPath, IsWhatThePersonSaysWhateverIsThere) {
  sut_.variables["THIMBLE_SOCKET"] = "/a.sock";
  there_ = {"/run/user/7/thimble.sock", "/run/thimble"};
  EXPECT_EQ(path(), "/a.sock");
}

TEST(DefaultFlightDirectory, TakesTheFirstOfItsSources) {
  Environment sut{{{"STATE_DIRECTORY", "/var/lib/thimble:/x"},
                   {"XDG_STATE_HOME", "/home/j/state"},
                   {"HOME", "/home/j"}},
                  7};
  EXPECT_EQ(default_flight_directory(sut), "/var/lib/thimble");
  sut.variables.erase("STATE_DIRECTORY");
  EXPECT_EQ(default_flight_directory(sut), "/home/j/state/thimble");
  sut.variables.erase("XDG_STATE_HOME");
  EXPECT_EQ(default_flight_directory(sut), "/home/j/.local/state/thimble");
  sut.variables.erase("HOME");
  EXPECT_EQ(default_flight_directory(sut), "/var/lib/thimble");
}

TEST(UdpEndpoint, IsReadBackAsItWasWritten) {
  for (const char* text : {"udp://127.0.0.1:5001", "udp://[::1]:0", "udp://10.0.0.2:65535"}) {
    const auto sut = parse_endpoint(text);
    ASSERT_TRUE(sut) << text;
    EXPECT_EQ(to_string(*sut), text);
  }
}

TEST(UdpEndpoint, RefusesEverythingElse) {
  for (const char* text :
       {"", "udp://", "udp://127.0.0.1", "udp://127.0.0.1:", "udp://127.0.0.1:65536",
        "udp://127.0.0.1:-1", "udp://127.0.0.1:1 ", "udp://::1:5001", "udp://[127.0.0.1]:1",
        "udp://host:1", "tcp://127.0.0.1:1", "udp://127.1:1", "udp://[]:1", "127.0.0.1:1"}) {
    EXPECT_FALSE(parse_endpoint(text)) << text;
  }
}

TEST(UdpEndpoint, KnowsLoopback) {
  EXPECT_TRUE(is_loopback("127.0.0.1"));
  EXPECT_TRUE(is_loopback("127.255.0.9"));
  EXPECT_TRUE(is_loopback("::1"));
  EXPECT_FALSE(is_loopback("128.0.0.1"));
  EXPECT_FALSE(is_loopback("0.0.0.0"));
  EXPECT_FALSE(is_loopback("::"));
  EXPECT_FALSE(is_loopback("localhost"));
}

}  // namespace
}  // namespace thimble::config
