#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

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

}  // namespace
}  // namespace thimble::api
