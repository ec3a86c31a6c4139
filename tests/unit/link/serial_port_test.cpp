#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <chrono>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/link/serial_arm_link.hpp"
#include "daemon/link/serial_frame.hpp"
#include "daemon/link/serial_world_server.hpp"
#include "daemon/link/tty_ports.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "hal/linux/serial_line.hpp"
#include "tests/unit/link/thimble_table.hpp"

// Both ends at terminals of the real kernel, joined by a cable that a test holds. Nothing here
// judges a time: waits are bounded generously, and end when what they wait for has happened.
namespace thimble::link {
namespace {

using linux::Descriptor;

// The master's end of a pseudo-terminal.
class Plug {
 public:
  Plug() : file_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    EXPECT_EQ(::grantpt(file_.get()), 0);
    EXPECT_EQ(::unlockpt(file_.get()), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(::ptsname_r(file_.get(), name.data(), name.size()), 0);
    node_ = name.data();
  }
  [[nodiscard]] const std::string& node() const { return node_; }
  std::vector<std::byte> take() {
    std::array<std::byte, 4096> buffer{};
    const ssize_t size = ::read(file_.get(), buffer.data(), buffer.size());
    return {buffer.data(), buffer.data() + std::max<ssize_t>(size, 0)};
  }
  // What finds no room is lost, as on a line.
  void put(std::span<const std::byte> bytes) {
    if (!bytes.empty()) (void)!::write(file_.get(), bytes.data(), bytes.size());
  }

 private:
  Descriptor file_;
  std::string node_;
};

// One direction of a cable: when it is free again, and what has not arrived.
struct Way {
  MonotonicTime free_at{};
  std::deque<std::pair<MonotonicTime, std::byte>> under_way{};
  std::optional<MonotonicTime> first_at{};  // of the first byte
  std::size_t written{0};
  std::size_t arrived{0};
  // The most that ever was ahead of the rate, bytes: what was written, since the ends were opened;
  // what arrived, since the first was written.
  double most_written{0};
  double most_arrived{0};
};

class SerialPorts : public ::testing::Test {
 protected:
  using Protocol = ArmEndSettings::Protocol;
  // Of which datagrams of 1999 tell one an axis.
  static constexpr Position3 kPastTheWalls{0.020, 0.020, 0.020};

  SerialPorts() { replug(); }

  void replug() {
    plugs.emplace_back();
    of_arm = &plugs.emplace_back();
    of_world = &plugs[plugs.size() - 2];
  }
  void open_both(Protocol protocol = Protocol::Thimble) {
    ends.protocol = protocol;
    opened_at = clock.now();
    arm = std::make_unique<SerialArmLink>(ports, clock,
                                          SerialArmLink::Settings{line("arm's"), ends}, nullptr);
    world = std::make_unique<SerialWorldServer>(
        ports, clock, SerialWorldServer::Settings{line("world's"), {}},
        UdpWorldServer::Worlds{.of_1999 = &world_of_1999,
                               .make_half = [this](const ThimbleHalf&)
                                   -> Result<std::unique_ptr<coupling::WorldCoupling>> {
                                 halves.push_back(std::make_unique<WorldDouble>());
                                 return std::make_unique<on_table::Half>(*halves.back());
                               }});
  }
  [[nodiscard]] SerialLine line(const char* end) const {
    return {.name = "serial:test", .node = end, .bit_per_s = bit_per_s};
  }
  [[nodiscard]] std::future<Result<LineNode>> ask(const std::string& end, std::uint32_t rate) {
    if (is_slow) return slow.emplace_back().get_future();
    std::promise<Result<LineNode>> answer;
    answer.set_value(open(end, rate));
    return answer.get_future();
  }
  // Whatever terminal is there when it is asked for.
  [[nodiscard]] Result<LineNode> open(const std::string& end, std::uint32_t rate) const {
    Plug* const plug = end == "arm's" ? of_arm : of_world;
    if (plug == nullptr) return fail(Errc::NotFound, "there is no such port");
    return linux::share_serial_line(plug->node(), rate);
  }
  bool run_until(const std::function<bool()>& is_done) {
    for (int i = 0; i < 20000; ++i) {
      if (is_done()) return true;
      if (io.stopped()) io.restart();
      arm->arm_end().send(
          {.sequence = ++sequence, .sampled_at = clock.now(), .hand = kPastTheWalls});
      arm->on_wake();
      if (of_arm != nullptr && of_world != nullptr) carry();
      io.run_one_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  void carry() {
    carry(*of_arm, *of_world, there);
    carry(*of_world, *of_arm, back);
  }
  // Ten bits a byte, where it is paced.
  void carry(Plug& from, Plug& to, Way& way) {
    const MonotonicTime now = clock.now();
    for (std::byte byte : from.take()) {
      if (!way.first_at) way.first_at = now;
      way.most_written = std::max(way.most_written, ahead(++way.written, opened_at, now));
      if (is_paced) way.free_at = std::max(way.free_at, now) + Duration(10'000'000'000 / bit_per_s);
      way.under_way.emplace_back(is_paced ? way.free_at : now, byte ^ turned);
    }
    std::vector<std::byte> out;
    for (; !way.under_way.empty() && way.under_way.front().first <= now;
         way.under_way.pop_front()) {
      out.push_back(way.under_way.front().second);
      way.most_arrived = std::max(way.most_arrived, ahead(++way.arrived, *way.first_at, now));
    }
    to.put(out);
  }
  // Bytes beyond those that the rate has room for.
  [[nodiscard]] double ahead(std::size_t bytes, MonotonicTime begin, MonotonicTime now) const {
    return static_cast<double>(bytes) - seconds(now - begin) * bit_per_s / 10;
  }
  [[nodiscard]] bool is_up() const { return arm->status().is_up; }

  linux::MonotonicClock clock;
  boost::asio::io_context io{1};
  TtyPorts ports{io, [this](const std::string& end, std::uint32_t rate) { return ask(end, rate); }};
  bool is_slow{false};  // both ends: nobody answers who opens
  std::deque<std::promise<Result<LineNode>>> slow;
  std::deque<Plug> plugs;
  Plug* of_arm{nullptr};
  Plug* of_world{nullptr};
  std::byte turned{0};  // what the cable does to every byte
  std::uint32_t bit_per_s{115'200};
  bool is_paced{false};
  MonotonicTime opened_at{};
  Way there;
  Way back;
  WorldDouble world_of_1999;
  std::vector<std::unique_ptr<WorldDouble>> halves;
  ArmEndSettings ends;
  std::unique_ptr<SerialWorldServer> world;
  std::unique_ptr<SerialArmLink> arm;
  std::uint64_t sequence{0};
};

TEST_F(SerialPorts, AnArmIsServedAlongALine) {
  open_both();
  ASSERT_TRUE(run_until([&] { return is_up() && !world->sessions().empty(); }));
  EXPECT_EQ(arm->status().peer, "serial:test");
  EXPECT_EQ(world->sessions()[0].peer, "serial:test");
  EXPECT_TRUE(world->status().is_up);
  coupling::ConstraintSet reply;
  ASSERT_TRUE(run_until([&] { return arm->arm_end().receive(reply); }));
  EXPECT_EQ(reply.planes.size(), 6U);
}

// The slowest rate, the fastest, and what is usual in between, with a cable that is no faster: no
// byte arrives before the rate has room for it, and no end has more than a frame on the line.
TEST_F(SerialPorts, AnArmIsServedByEitherProtocolAtEveryRateThatTheCableIsPacedAt) {
  is_paced = true;
  for (const auto& [protocol, planes] :
       {std::pair{Protocol::Thimble, 6U}, std::pair{Protocol::Thesis, 3U}}) {
    for (const std::uint32_t rate : {38'400U, 115'200U, 460'800U, 1'000'000U, 3'000'000U}) {
      SCOPED_TRACE(rate);
      bit_per_s = rate;
      there = back = {};
      replug();
      open_both(protocol);
      for (int replies = 0; replies < 5; ++replies) {
        coupling::ConstraintSet reply;
        ASSERT_TRUE(run_until([&] { return arm->arm_end().receive(reply); }));
        EXPECT_EQ(reply.planes.size(), planes);
      }
      EXPECT_EQ(arm->status().counters.receive_errors, 0U);
      EXPECT_EQ(world->status().counters.receive_errors, 0U);
      for (const Way& way : {there, back}) {
        EXPECT_GT(way.arrived, 50U);
        EXPECT_LE(way.most_arrived, 1);  // a byte's time is rounded to nanoseconds
        EXPECT_LE(way.most_written, static_cast<double>(kMaxSerialFrame));
      }
    }
  }
}

TEST_F(SerialPorts, APortThatIsNotThereIsWaitedFor) {
  Plug* const later = std::exchange(of_arm, nullptr);
  open_both();
  ASSERT_TRUE(run_until([&] { return !arm->status().last_error.empty(); }));
  EXPECT_EQ(arm->status().last_error, "there is no such port");
  of_arm = later;
  ASSERT_TRUE(run_until([&] { return is_up(); }));
  EXPECT_EQ(arm->status().last_error, "");
}

TEST_F(SerialPorts, AnOpeningThatLastsHoldsUpNobodyAndIsAskedForOnce) {
  is_slow = true;
  open_both();
  // What runs on the same thread goes on.
  int runs = 0;
  const std::function<void()> again = [&] {
    if (++runs < 100) boost::asio::post(io, again);
  };
  boost::asio::post(io, again);
  ASSERT_TRUE(run_until([&] { return runs == 100; }));
  EXPECT_EQ(slow.size(), 2U);
  EXPECT_FALSE(is_up());
  slow[0].set_value(open("arm's", bit_per_s));
  slow[1].set_value(open("world's", bit_per_s));
  ASSERT_TRUE(run_until([&] { return is_up(); }));
  EXPECT_EQ(slow.size(), 2U);
}

TEST_F(SerialPorts, AnOpeningThatIsGivenUpIsAskedForAgain) {
  is_slow = true;
  open_both();
  is_slow = false;
  slow.clear();  // whose promises are broken
  ASSERT_TRUE(run_until([&] { return !arm->status().last_error.empty(); }));
  EXPECT_EQ(arm->status().last_error, "who opens the line gave it up");
  ASSERT_TRUE(run_until([&] { return is_up(); }));
}

TEST_F(SerialPorts, APortMayEndWhileItIsBeingOpened) {
  is_slow = true;
  open_both();
  arm.reset();
  world.reset();
  const auto node = open("arm's", bit_per_s).value();
  slow[0].set_value(node);
  slow.clear();
  io.run_for(std::chrono::milliseconds(50));
  EXPECT_EQ(node.use_count(), 1) << "nobody has it";
}

TEST_F(SerialPorts, APortThatGoesIsToldOfAndTakenUpAgain) {
  open_both();
  ASSERT_TRUE(run_until([&] { return is_up(); }));
  of_arm = of_world = nullptr;
  plugs.clear();
  // Each end notices by itself.
  ASSERT_TRUE(run_until([&] {
    return !is_up() && !arm->status().last_error.empty() && !world->status().last_error.empty();
  }));
  replug();
  ASSERT_TRUE(run_until([&] { return is_up(); }));
}

TEST_F(SerialPorts, APortThatSomebodyElseHoldsIsSaidToBe) {
  const auto held = linux::share_serial_line(of_arm->node(), 115'200);
  ASSERT_TRUE(held);
  const auto again = linux::share_serial_line(of_arm->node(), 115'200);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, Errc::Busy);
  open_both();
  ASSERT_TRUE(run_until([&] { return !arm->status().last_error.empty(); }));
  EXPECT_NE(arm->status().last_error.find("held by another"), std::string::npos);
}

TEST_F(SerialPorts, WhatIsNoTerminalIsSaidToBeNone) {
  const auto none = linux::share_serial_line("/dev/null", 115'200);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("is no terminal"), std::string::npos);
}

TEST_F(SerialPorts, AnotherBitRateIsGuessedFromGibberish) {
  turned = std::byte{0x55};
  open_both();
  const auto guess = [](const LinkStatus& status) {
    return status.last_error.find("does the other end run at 115200 bit/s?") != std::string::npos;
  };
  ASSERT_TRUE(run_until([&] {
    arm->on_wake();
    of_world->put(std::array{std::byte{0}, std::byte{9}, std::byte{0}});
    return guess(world->status());
  }));
  EXPECT_FALSE(is_up());
  EXPECT_TRUE(halves.empty());
}

TEST_F(SerialPorts, AFarEndThatTakesNothingStallsNothing) {
  open_both();
  ASSERT_TRUE(run_until([&] { return is_up(); }));
  Plug* const arms = std::exchange(of_arm, nullptr);  // nobody reads what either end writes
  ASSERT_TRUE(run_until([&] { return !is_up() && world->sessions().empty(); }));
  of_arm = arms;
  ASSERT_TRUE(run_until([&] { return is_up(); }));
}

TEST_F(SerialPorts, MayBeDestroyedWhileTheLoopStillHoldsItsHandlers) {
  open_both();
  ASSERT_TRUE(run_until([&] { return is_up(); }));
  arm.reset();
  world.reset();
  io.poll();
  SUCCEED();
}

}  // namespace
}  // namespace thimble::link
