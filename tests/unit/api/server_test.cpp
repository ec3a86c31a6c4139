#include "daemon/api/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace thimble::api {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// One arm held by clients, one by the configuration.
class FakeDaemon : public StatusView, public Commands {
 public:
  [[nodiscard]] Status status() const override {
    ++statuses;
    Status out;
    out.version = std::string(padding, 'v');
    out.arms.resize(2);
    out.arms[0].name = "right";
    out.arms[0].lease = lease;
    out.arms[1].name = "left";
    out.arms[1].lease = "configuration";
    return out;
  }
  void activate(std::string_view arm, ClientId client, Answer answer) override {
    if (arm != "right" && arm != "left") {
      return answer(fail(Errc::NotFound, "there is no such arm"));
    }
    if (arm == "right" && lease == "client") return answer(fail(Errc::Busy, "held by another"));
    if (arm == "right") lease = "client";
    log.push_back("activate " + std::string(arm));
    holder = client;
    answer(Done{"active", ""});
  }
  void deactivate(std::string_view arm, ClientId, Answer answer) override {
    log.push_back("deactivate " + std::string(arm));
    lease = "none";
    answer(Done{"inactive", ""});
  }
  void clear_fault(std::string_view arm, std::optional<std::uint32_t> fault, ClientId,
                   Answer answer) override {
    log.push_back("clear-fault " + std::string(arm) + (fault ? " " + std::to_string(*fault) : ""));
    if (is_slow) {
      later = std::move(answer);
    } else {
      answer(Done{"calibrating", "press the button"});
    }
  }
  void steady_force(std::string_view, std::optional<double>, ClientId, Answer) override {}
  void edit_world(std::string_view world, const std::vector<CellEdit>& edits, ClientId,
                  EditAnswer answer) override {
    log.push_back("edit " + std::string(world) + " " + std::to_string(edits.size()));
    if (world != "box") return answer(fail(Errc::Unsupported, "it has no cells"));
    answer(Edited{edits.size(), 5});
  }
  void act_on_pieces(std::string_view, PieceVerb, ClientId, PieceAnswer) override {}
  void client_gone(ClientId client) override {
    log.push_back("gone");
    if (client == holder) lease = "none";
  }
  std::vector<std::string> log;
  std::string lease{"none"};
  ClientId holder{};
  std::size_t padding{1};
  mutable int statuses{0};  // asked for
  bool is_slow{false};      // keeps the answer to clear-fault
  Answer later;
};

// A client on a plain non-blocking descriptor, so that nothing of the server's library tests
// itself.
class Client {
 public:
  explicit Client(const std::string& path)
      : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    is_connected_ =
        ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~Client() { close(); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  [[nodiscard]] bool is_connected() const { return is_connected_; }
  void send(std::string_view bytes) const {
    static_cast<void>(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
  }
  // Takes what has arrived; false once the server has closed.
  bool receive() {
    char buffer[65536];
    const auto size = ::recv(socket_, buffer, sizeof buffer, MSG_DONTWAIT);
    if (size > 0) received.append(buffer, static_cast<std::size_t>(size));
    return size > 0 || (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK));
  }

  std::string received;

 private:
  int socket_;
  bool is_connected_{false};
};

class ServerTest : public testing::Test {
 protected:
  ServerTest() { settings_.socket_path = (folder_ / "t.sock").string(); }

  void start() {
    auto server = Server::create(context_, settings_, daemon_, daemon_);
    ASSERT_TRUE(server) << server.error().message;
    sut_ = std::move(*server);
  }
  // Runs the server until `condition`; the bound only ends a test that has failed already.
  testing::AssertionResult until(const std::function<bool()>& condition) {
    for (int i = 0; i < 2000; ++i) {
      if (condition()) return testing::AssertionSuccess();
      context_.restart();
      context_.run_one_for(std::chrono::milliseconds(5));
    }
    return testing::AssertionFailure() << "it never happened";
  }
  std::string ask(Client& client, const std::string& request) {
    client.received.clear();
    client.send(request);
    const auto is_answered = [&] {
      client.receive();
      return client.received.ends_with("}\n");
    };
    EXPECT_TRUE(until(is_answered)) << client.received;
    return client.received;
  }
  static std::string post(const std::string& target) {
    return "POST " + target + " HTTP/1.1\r\nHost: x\r\nContent-Length: 0\r\n\r\n";
  }
  bool ends(Client& client) {
    return static_cast<bool>(until([&] { return !client.receive(); }));
  }

  testing_support::TemporaryFolder folder_;
  boost::asio::io_context context_;
  FakeDaemon daemon_;
  ServerSettings settings_;
  std::unique_ptr<Server> sut_;
};

constexpr const char* kGetStatus = "GET /v1/status HTTP/1.1\r\nHost: x\r\n\r\n";

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

TEST_F(ServerTest, TurnsAwayConnectionsBeyondTheLimit) {
  settings_.max_connections = 2;
  start();
  Client first(settings_.socket_path);
  Client second(settings_.socket_path);
  ask(first, kGetStatus);
  ask(second, kGetStatus);
  Client third(settings_.socket_path);
  EXPECT_TRUE(ends(third));
  EXPECT_THAT(third.received, AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("too many")));
  second.close();
  EXPECT_TRUE(until([&] { return sut_->connections() == 1; }));
  Client fourth(settings_.socket_path);
  EXPECT_THAT(ask(fourth, kGetStatus), StartsWith("HTTP/1.1 200"));
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
