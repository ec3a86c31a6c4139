#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "daemon/api/server.hpp"
#include "tests/unit/api/server_fixture.hpp"

namespace thimble::api {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST_F(ServerTest, TheLongestSilentWithoutALeaseMakesRoom) {
  settings_.max_connections = 3;
  start();
  Client holder(settings_.socket_path);
  ask(holder, post("/v1/arms/right/activate"));
  Client first(settings_.socket_path);
  ask(first, kGetStatus);
  Client second(settings_.socket_path);
  ask(second, kGetStatus);
  ask(first, kGetStatus);
  Client third(settings_.socket_path);
  EXPECT_THAT(ask(third, kGetStatus), StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(ends(second));
  EXPECT_THAT(ask(first, kGetStatus), StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(sut_->connections(), 3U);
  EXPECT_EQ(daemon_.lease, "client");
}

// However many others do nothing, or come anew as soon as they are dropped.
TEST_F(ServerTest, AnArmCanBeStoppedWhoeverKeepsConnections) {
  settings_.max_connections = 4;
  start();
  Client holder(settings_.socket_path);
  ask(holder, post("/v1/arms/right/activate"));
  std::vector<std::unique_ptr<Client>> silent;
  for (int i = 0; i < 40; ++i) {
    silent.push_back(std::make_unique<Client>(settings_.socket_path));
    silent.back()->send("GET /v1/st");  // is nothing whole
    context_.restart();
    context_.poll();
  }
  EXPECT_EQ(sut_->connections(), 4U);
  Client stops(settings_.socket_path);
  EXPECT_THAT(ask(stops, post("/v1/arms/right/deactivate")), StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(daemon_.lease, "none");
}

TEST_F(ServerTest, OneWhoseCommandWaitsAndWhoMakesRoomTakesItBack) {
  settings_.max_connections = 1;
  start();
  daemon_.is_slow = true;
  Client slow(settings_.socket_path);
  slow.send(post("/v1/arms/right/clear-fault"));
  ASSERT_TRUE(until([&] { return daemon_.later != nullptr; }));
  Client other(settings_.socket_path);
  EXPECT_THAT(ask(other, kGetStatus), StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(ends(slow));
  EXPECT_THAT(daemon_.log, ElementsAre("clear-fault right", "gone"));
  std::exchange(daemon_.later, nullptr)(Done{"inactive", ""});
  EXPECT_EQ(sut_->connections(), 1U);
}

TEST_F(ServerTest, TurnsAwayWhoFindsLeasesOnly) {
  settings_.max_connections = 1;
  start();
  Client holder(settings_.socket_path);
  ask(holder, post("/v1/arms/right/activate"));
  Client other(settings_.socket_path);
  EXPECT_TRUE(ends(other));
  EXPECT_THAT(other.received, AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("too many")));
  holder.close();
  EXPECT_TRUE(until([&] { return sut_->connections() == 0; }));
  Client later(settings_.socket_path);
  EXPECT_THAT(ask(later, kGetStatus), StartsWith("HTTP/1.1 200"));
}

}  // namespace
}  // namespace thimble::api
