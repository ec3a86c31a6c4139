#include "daemon/app/service_notifier.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace thimble::app {
namespace {

// A service manager's socket with a name of its own; it reads only when it is told to.
class Listener {
 public:
  Listener() : name_("@thimble-notifier-test-" + std::to_string(::getpid())) {
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name_.copy(address.sun_path, name_.size());
    address.sun_path[0] = '\0';
    const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name_.size());
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), bytes), 0);
  }
  ~Listener() { ::close(socket_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  std::vector<std::string> read_all() const {
    std::vector<std::string> out;
    std::array<char, 4096> bytes{};
    while (true) {
      const ssize_t size = ::recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (size < 0) return out;
      out.emplace_back(bytes.data(), static_cast<std::size_t>(size));
    }
  }

 private:
  std::string name_;
  int socket_{-1};
};

using Messages = std::vector<std::string>;

TEST(ServiceNotifier, SaysEachThingAtOnceToAListenerThatReads) {
  const Listener listener;
  ServiceNotifier sut(listener.name());
  sut.ready("running");
  EXPECT_EQ(listener.read_all(), Messages{"READY=1\nSTATUS=running\n"});
  sut.status("right active");
  sut.alive();
  EXPECT_EQ(listener.read_all(), (Messages{"STATUS=right active\n", "WATCHDOG=1\n"}));
  sut.stopping();
  EXPECT_EQ(listener.read_all(), Messages{"STOPPING=1\nSTATUS=the force ramps to zero\n"});
  sut.retry();
  EXPECT_TRUE(listener.read_all().empty());
}

// With a call that waits this test would never end.
TEST(ServiceNotifier, OwesAListenerThatDoesNotReadTheNewestAndNeverWaits) {
  const Listener listener;
  ServiceNotifier sut(listener.name());
  for (int i = 0; i < 3000; ++i) sut.status(std::to_string(i));
  sut.ready("running");
  sut.alive();
  sut.alive();
  sut.status("newest");
  const Messages taken = listener.read_all();
  ASSERT_FALSE(taken.empty());
  EXPECT_EQ(taken.front(), "STATUS=0\n");
  for (const std::string& message : taken) EXPECT_EQ(message.find("READY"), std::string::npos);
  sut.retry();
  EXPECT_EQ(listener.read_all(), Messages{"READY=1\nWATCHDOG=1\nSTATUS=newest\n"});
  sut.retry();
  EXPECT_TRUE(listener.read_all().empty());
}

TEST(ServiceNotifier, DoesNothingWhenNobodyListens) {
  const Listener other;
  const std::string long_name = "/" + std::string(5000, 'x');
  const std::string shorter = other.name().substr(0, other.name().size() - 1);
  for (const std::string& name :
       {std::string(), std::string("relative"), long_name, std::string("/nowhere/notify"),
        std::string("@thimble-nobody"), shorter, other.name() + "x"}) {
    ServiceNotifier sut(name);
    sut.ready("running");
    sut.alive();
    sut.stopping();
  }
  EXPECT_TRUE(other.read_all().empty());
}

}  // namespace
}  // namespace thimble::app
