#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/unit/api/server_fixture.hpp"

namespace thimble::api {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string put(const std::string& bytes) {
  return "PUT /v1/worlds/dish/state HTTP/1.1\r\nHost: x\r\nContent-Length: " +
         std::to_string(bytes.size()) + "\r\n\r\n" + bytes;
}
std::string get(const std::string& world) {
  return "GET /v1/worlds/" + world + "/state HTTP/1.1\r\nHost: x\r\n\r\n";
}

TEST_F(ServerTest, GivesTheStateOfAWorldAsItIs) {
  start();
  Client client(settings_.socket_path);
  EXPECT_THAT(ask(client, get("dish")),
              AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("application/octet-stream"),
                    HasSubstr("\r\n\r\n" + daemon_.state)));
  EXPECT_THAT(ask(client, get("box")),
              AllOf(StartsWith("HTTP/1.1 501"), HasSubstr("does not run")));
}

TEST_F(ServerTest, GivesTheCellsOfAWorld) {
  start();
  Client client(settings_.socket_path);
  EXPECT_THAT(ask(client, "GET /v1/worlds/dish/cells HTTP/1.1\r\nHost: x\r\n\r\n"),
              AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("application/octet-stream"),
                    HasSubstr("\r\n\r\nNRRD{}\n")));
  EXPECT_THAT(ask(client, "GET /v1/worlds/ball/cells HTTP/1.1\r\nHost: x\r\n\r\n"),
              AllOf(StartsWith("HTTP/1.1 501"), HasSubstr("made of no cells")));
}

TEST_F(ServerTest, TakesAStateWhichIsLongerThanOtherBodies) {
  settings_.max_state_bytes = 4 * settings_.max_body_bytes;
  start();
  Client client(settings_.socket_path);
  const std::string large(settings_.max_state_bytes, '\xfe');
  const std::string request = put(large);
  constexpr std::size_t kAtOnce = 4096;
  for (std::size_t i = 0; i < request.size(); i += kAtOnce) {
    client.send(request.substr(i, kAtOnce));
    context_.poll();
  }
  EXPECT_THAT(ask(client, ""), AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("\"steps\": 12")));
  EXPECT_EQ(daemon_.state, large);
}

TEST_F(ServerTest, RefusesAStateBeyondItsLimitByItsHeader) {
  settings_.max_state_bytes = 4 * settings_.max_body_bytes;
  start();
  Client client(settings_.socket_path);
  const std::string request = put(std::string(settings_.max_state_bytes + 1, 'x'));
  EXPECT_THAT(ask(client, request.substr(0, request.find("\r\n\r\n") + 4)),
              StartsWith("HTTP/1.1 413"));
  EXPECT_TRUE(ends(client));
}

TEST_F(ServerTest, ServesOthersWhileAStateWaitsForItsTurn) {
  start();
  daemon_.is_slow = true;
  Client slow(settings_.socket_path);
  slow.send(get("dish"));
  ASSERT_TRUE(until([&] { return daemon_.later_state != nullptr; }));
  Client other(settings_.socket_path);
  EXPECT_THAT(ask(other, kGetStatus), StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(slow.receive());
  EXPECT_EQ(slow.received, "");
  std::exchange(daemon_.later_state, nullptr)(std::string("{}\n"));
  ASSERT_TRUE(until([&] { return slow.receive() && slow.received.ends_with("}\n"); }));
  EXPECT_THAT(slow.received, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("\r\n\r\n{}\n")));
}

// Whoever does the work is told that nobody waits for it any more; an answer that comes all the
// same does no harm.
TEST_F(ServerTest, NoticesAClientThatGoesWhileItsStateWaits) {
  start();
  daemon_.is_slow = true;
  {
    Client client(settings_.socket_path);
    client.send(get("dish"));
    ASSERT_TRUE(until([&] { return daemon_.later_state != nullptr; }));
    Client other(settings_.socket_path);
    other.send(put("x"));
    ASSERT_TRUE(until([&] { return daemon_.later_load != nullptr; }));
  }
  EXPECT_TRUE(until([&] { return sut_->connections() == 0; }));
  EXPECT_THAT(daemon_.log, testing::ElementsAre("gone", "gone"));
  sut_.reset();
  daemon_.later_state(std::string("{}\n"));
  daemon_.later_load(12);
}

}  // namespace
}  // namespace thimble::api
