#include "daemon/api/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <utility>
#include <vector>

#include "tests/unit/api/server_fixture.hpp"

namespace thimble::api {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

TEST_F(ServerTest, TellsTheStatusOverAndOverOnOneConnection) {
  start();
  Client client(settings_.socket_path);
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(ask(client, kGetStatus),
                AllOf(StartsWith("HTTP/1.1 200 OK"), HasSubstr("application/json"),
                      HasSubstr("\"version\": \"v\"")));
  }
  EXPECT_EQ(sut_->connections(), 1U);
}

TEST_F(ServerTest, ReadsARequestThatComesByteByByte) {
  start();
  Client client(settings_.socket_path);
  for (const char* c = kGetStatus; *c != '\0'; ++c) {
    client.send(std::string_view(c, 1));
    context_.poll();
  }
  EXPECT_THAT(ask(client, ""), StartsWith("HTTP/1.1 200 OK"));
}

TEST_F(ServerTest, SaysWhoHoldsTheLease) {
  start();
  Client client(settings_.socket_path);
  EXPECT_THAT(ask(client, post("/v1/arms/right/activate")), HasSubstr("\"lease\": \"client\""));
  EXPECT_THAT(ask(client, post("/v1/arms/left/activate")),
              HasSubstr("\"lease\": \"configuration\""));
}

TEST_F(ServerTest, SaysHowTheArmStandsWhenTheCommandHasComeTrue) {
  start();
  Client client(settings_.socket_path);
  EXPECT_THAT(ask(client, post("/v1/arms/right/clear-fault")),
              AllOf(HasSubstr("\"state\": \"calibrating\""),
                    HasSubstr("\"instruction\": \"press the button\"")));
}

TEST_F(ServerTest, HandsOnWhichFaultIsToBeCleared) {
  start();
  Client client(settings_.socket_path);
  const std::string body = R"({"fault": 12})";
  const std::string request = "POST /v1/arms/right/clear-fault HTTP/1.1\r\nHost: t\r\n" +
                              ("Content-Length: " + std::to_string(body.size())) + "\r\n\r\n";
  EXPECT_THAT(ask(client, request + body), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(daemon_.log, ElementsAre("clear-fault right 12"));
}

TEST_F(ServerTest, HandsOnWhatIsAskedOfTheWorldOfAnArm) {
  start();
  Client client(settings_.socket_path);
  EXPECT_THAT(ask(client, post("/v1/arms/right/free")), HasSubstr("\"state\": \"active\""));
  EXPECT_EQ(daemon_.log.back(), "free of right");
  EXPECT_THAT(ask(client, post("/v1/arms/left/reset")),
              AllOf(StartsWith("HTTP/1.1 501"), HasSubstr("its world does not do that")));
  EXPECT_EQ(daemon_.log.back(), "reset of left");
}

TEST_F(ServerTest, AnswersLaterAndServesOthersMeanwhile) {
  start();
  daemon_.is_slow = true;
  Client slow(settings_.socket_path);
  slow.send(post("/v1/arms/right/clear-fault"));
  ASSERT_TRUE(until([&] { return daemon_.later != nullptr; }));
  Client other(settings_.socket_path);
  EXPECT_THAT(ask(other, kGetStatus), StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(slow.receive());
  EXPECT_EQ(slow.received, "");
  std::exchange(daemon_.later, nullptr)(fail(Errc::Timeout, "in vain"));
  ASSERT_TRUE(until([&] { return slow.receive() && slow.received.ends_with("}\n"); }));
  EXPECT_THAT(slow.received, AllOf(StartsWith("HTTP/1.1 504"), HasSubstr("in vain")));
}

TEST_F(ServerTest, AnAnswerToAClosedConnectionIsHarmless) {
  start();
  daemon_.is_slow = true;
  {
    Client client(settings_.socket_path);
    client.send(post("/v1/arms/right/clear-fault"));
    ASSERT_TRUE(until([&] { return daemon_.later != nullptr; }));
  }
  sut_.reset();
  EXPECT_THAT(daemon_.log, ElementsAre("clear-fault right", "gone"));
  daemon_.later(Done{"inactive", ""});
}

// Else clients that come and go while commands wait keep everybody out.
TEST_F(ServerTest, NoticesAClientThatGoesWhileItsCommandWaits) {
  start();
  daemon_.is_slow = true;
  {
    Client client(settings_.socket_path);
    client.send(post("/v1/arms/right/clear-fault"));
    ASSERT_TRUE(until([&] { return daemon_.later != nullptr; }));
  }
  EXPECT_TRUE(until([&] { return sut_->connections() == 0; }));
  EXPECT_THAT(daemon_.log, ElementsAre("clear-fault right", "gone"));
  daemon_.later(Done{"inactive", ""});
}

TEST_F(ServerTest, ReleasesAnArmWhenItsConnectionCloses) {
  start();
  Client client(settings_.socket_path);
  ask(client, post("/v1/arms/right/activate"));
  client.close();
  EXPECT_TRUE(until([&] { return sut_->connections() == 0; }));
  EXPECT_THAT(daemon_.log, ElementsAre("activate right", "gone"));
  EXPECT_EQ(daemon_.lease, "none");
}

TEST_F(ServerTest, ReleasesAnArmWhenTheServerEnds) {
  start();
  Client client(settings_.socket_path);
  ask(client, post("/v1/arms/right/activate"));
  sut_.reset();
  EXPECT_THAT(daemon_.log, ElementsAre("activate right", "gone"));
  EXPECT_TRUE(ends(client));
  EXPECT_FALSE(std::filesystem::exists(settings_.socket_path));
}

TEST_F(ServerTest, DoesNotMentionAClientThatOnlyLooked) {
  start();
  Client client(settings_.socket_path);
  ask(client, kGetStatus);
  client.close();
  EXPECT_TRUE(until([&] { return sut_->connections() == 0; }));
  EXPECT_THAT(daemon_.log, IsEmpty());
}

TEST_F(ServerTest, AnswersRefusalsWithTheirStatusAndGoesOn) {
  start();
  Client client(settings_.socket_path);
  Client other(settings_.socket_path);
  EXPECT_THAT(ask(client, post("/v1/arms/nobody/activate")),
              AllOf(StartsWith("HTTP/1.1 404"), HasSubstr("\"code\": \"not-found\""),
                    HasSubstr("there is no such arm")));
  EXPECT_THAT(ask(client, post("/v1/status")),
              AllOf(StartsWith("HTTP/1.1 405"), HasSubstr("Allow: GET")));
  ask(client, post("/v1/arms/right/activate"));
  EXPECT_THAT(ask(other, post("/v1/arms/right/activate")), StartsWith("HTTP/1.1 409"));
  EXPECT_THAT(ask(other, post("/v1/arms/right/clear-fault")), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(ask(other, post("/v1/arms/right/deactivate")),
              AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("\"lease\": \"none\"")));
}

TEST_F(ServerTest, RefusesWhatIsNoHttpAndCloses) {
  start();
  Client client(settings_.socket_path);
  EXPECT_THAT(ask(client, "\x01\x02\x03 hello\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_TRUE(ends(client));
}

TEST_F(ServerTest, RefusesHeadersAndBodiesBeyondTheLimits) {
  start();
  Client header(settings_.socket_path);
  EXPECT_THAT(ask(header, "GET /v1/status HTTP/1.1\r\nX: " + std::string(9000, 'x')),
              StartsWith("HTTP/1.1 431"));
  EXPECT_TRUE(ends(header));
  Client body(settings_.socket_path);
  EXPECT_THAT(ask(body, "POST /v1/arms/right/activate HTTP/1.1\r\nContent-Length: 16385\r\n\r\n"),
              StartsWith("HTTP/1.1 413"));
  EXPECT_TRUE(ends(body));
  EXPECT_THAT(daemon_.log, IsEmpty());
}

TEST_F(ServerTest, DropsAnIdleConnectionUnlessItHoldsALease) {
  settings_.idle_timeout = std::chrono::milliseconds(20);
  start();
  Client holder(settings_.socket_path);
  ask(holder, post("/v1/arms/right/activate"));
  Client idle(settings_.socket_path);
  EXPECT_TRUE(ends(idle));
  EXPECT_EQ(daemon_.lease, "client");
  EXPECT_TRUE(until([&] { return sut_->connections() == 1; }));
  ask(holder, post("/v1/arms/right/deactivate"));
  EXPECT_TRUE(ends(holder));
}

// A person looks at a scale meanwhile, be the arm the configuration's.
TEST_F(ServerTest, KeepsAnIdleConnectionThatGaveASteadyForceUntilItTakesItBack) {
  settings_.idle_timeout = std::chrono::milliseconds(20);
  start();
  Client pushing(settings_.socket_path);
  ask(pushing, post("/v1/arms/right/steady-force", R"({"up_newton": -1})"));
  ASSERT_EQ(daemon_.lease, "none");
  Client idle(settings_.socket_path);
  EXPECT_TRUE(ends(idle));
  EXPECT_TRUE(until([&] { return sut_->connections() == 1; }));
  ask(pushing, post("/v1/arms/right/steady-force"));
  EXPECT_TRUE(ends(pushing));
  Client other(settings_.socket_path);
  ask(other, post("/v1/arms/right/steady-force", R"({"up_newton": -1})"));
  ask(other, post("/v1/arms/right/clear-fault"));
  EXPECT_TRUE(ends(other)) << "its force is over";
}

TEST_F(ServerTest, TellsTheNumberOfALeaseAndAnotherOnesDoesNotKeepAConnection) {
  settings_.idle_timeout = std::chrono::milliseconds(20);
  start();
  Client first(settings_.socket_path);
  EXPECT_THAT(ask(first, post("/v1/arms/right/activate")), HasSubstr("\"lease_number\": 1,"));
  Client second(settings_.socket_path);
  EXPECT_THAT(ask(second, post("/v1/arms/right/deactivate")), HasSubstr("\"lease_number\": 0,"));
  EXPECT_THAT(ask(second, post("/v1/arms/right/activate")), HasSubstr("\"lease_number\": 2,"));
  EXPECT_THAT(ask(first, kGetStatus), HasSubstr("\"lease_number\": 2,"));
  EXPECT_TRUE(ends(first));
  EXPECT_EQ(daemon_.lease, "client") << "of the second";
  EXPECT_TRUE(until([&] { return sut_->connections() == 1; }));
}

TEST_F(ServerTest, DropsAReaderThatNeverReads) {
  daemon_.padding = 1U << 20U;  // more than a socket buffer takes
  settings_.write_timeout = std::chrono::milliseconds(20);
  start();
  Client client(settings_.socket_path);
  client.send(kGetStatus);
  EXPECT_TRUE(until([&] { return sut_->connections() == 1; }));
  EXPECT_TRUE(until([&] { return sut_->connections() == 0; }));
}

// While it does not read, others are served; then its arm is free again.
TEST_F(ServerTest, DropsAHolderThatStopsReadingAndFreesItsArm) {
  settings_.write_timeout = std::chrono::milliseconds(200);
  start();
  Client holder(settings_.socket_path);
  ask(holder, post("/v1/arms/right/activate"));
  ASSERT_EQ(daemon_.lease, "client");
  context_.restart();
  context_.poll();  // it waits for the next request, and has asked whether a lease is held
  daemon_.padding = 1U << 20U;
  daemon_.statuses = 0;
  holder.send(kGetStatus);
  EXPECT_TRUE(until([&] { return daemon_.statuses > 0; }));
  daemon_.padding = 0;
  Client other(settings_.socket_path);
  EXPECT_THAT(ask(other, kGetStatus), StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(until([&] { return sut_->connections() == 1; }));
  EXPECT_EQ(daemon_.lease, "none");
}

TEST_F(ServerTest, LeavesHandlersInFlightHarmless) {
  start();
  Client client(settings_.socket_path);
  client.send(kGetStatus);
  EXPECT_TRUE(until([&] { return sut_->connections() == 1; }));
  sut_.reset();
  context_.restart();
  context_.poll();
  EXPECT_THAT(daemon_.log, IsEmpty());
}

TEST_F(ServerTest, DoesNotStartBesideAnother) {
  start();
  const auto second = Server::create(context_, settings_, daemon_, daemon_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, Errc::Busy);
}

}  // namespace
}  // namespace thimble::api
