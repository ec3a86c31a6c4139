#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/api/server.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::api {

inline constexpr const char* kGetStatus = "GET /v1/status HTTP/1.1\r\nHost: x\r\n\r\n";

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
    out.arms[0].lease_number = lease == "client" ? granted : 0;
    out.arms[1].name = "left";
    out.arms[1].lease = "configuration";
    return out;
  }
  void activate(std::string_view arm, ClientId client, Answer answer) override {
    if (arm != "right" && arm != "left") {
      return answer(fail(Errc::NotFound, "there is no such arm"));
    }
    if (arm == "right" && lease == "client") return answer(fail(Errc::Busy, "held by another"));
    if (arm == "right") {
      lease = "client";
      ++granted;
    }
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
  void steady_force(std::string_view, std::optional<double>, ClientId, Answer answer) override {
    answer(Done{"active", ""});
  }
  void set_impedance(std::string_view arm, double newton_s_per_m, Answer answer) override {
    log.push_back("impedance " + std::string(arm) + " " + std::to_string(newton_s_per_m));
    if (arm != "right") return answer(fail(Errc::Unsupported, "it has no impedance to tune"));
    answer(Done{"active", ""});
  }
  void ask_world(std::string_view arm, HandVerb verb, Answer answer) override {
    log.push_back((verb == HandVerb::Reset ? "reset of " : "free of ") + std::string(arm));
    if (arm != "right") return answer(fail(Errc::Unsupported, "its world does not do that"));
    answer(Done{"active", ""});
  }
  void edit_world(std::string_view world, const std::vector<CellEdit>& edits, ClientId,
                  EditAnswer answer) override {
    log.push_back("edit " + std::string(world) + " " + std::to_string(edits.size()));
    if (world != "box") return answer(fail(Errc::Unsupported, "it has no cells"));
    answer(Edited{edits.size(), 5});
  }
  void act_on_pieces(std::string_view, PieceVerb, ClientId, PieceAnswer) override {}
  void read_cells(std::string_view world, ClientId, FileAnswer answer) override {
    if (world != "dish") return answer(fail(Errc::Unsupported, "it is made of no cells"));
    answer(std::string("NRRD{}\n"));
  }
  void save_world(std::string_view world, ClientId, FileAnswer answer) override {
    if (world != "dish") return answer(fail(Errc::Unsupported, "it does not run"));
    if (is_slow) {
      later_state = std::move(answer);
    } else {
      answer(state);
    }
  }
  void load_world(std::string_view world, std::string bytes, ClientId, LoadAnswer answer) override {
    if (world != "dish") return answer(fail(Errc::Unsupported, "it does not run"));
    state = std::move(bytes);
    if (is_slow) {
      later_load = std::move(answer);
    } else {
      answer(12);
    }
  }
  void client_gone(ClientId client) override {
    log.push_back("gone");
    if (client == holder) lease = "none";
  }
  std::vector<std::string> log;
  std::string state{"\xff\0{}\n", 5};
  std::string lease{"none"};
  std::uint64_t granted{0};  // leases of clients
  ClientId holder{};
  std::size_t padding{1};
  mutable int statuses{0};  // asked for
  bool is_slow{false};      // keeps the answers to clear-fault and of states
  Answer later;
  FileAnswer later_state;
  LoadAnswer later_load;
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
  static std::string post(const std::string& target, const std::string& body = {}) {
    return "POST " + target +
           " HTTP/1.1\r\nHost: x\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
           body;
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

}  // namespace thimble::api
