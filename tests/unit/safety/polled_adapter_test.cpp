// The chain behind a chip whose kernel driver polls it for edges, as that of a CP2112 would
// (hal/linux asks it for none).
#include <gtest/gtest.h>

#include <array>
#include <deque>

#include "daemon/safety/safety_chain.hpp"

namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

// Levels are those of the wires whenever they are read, which is every 20 ms; an edge is told by
// the first poll that finds its wire changed. Linux 6.1, hid-cp2112.c: polls 40 ms apart, and the
// transfers.
class PolledLines final : public bus::GpioLines {
 public:
  static constexpr Duration kPoll = milliseconds(55);

  explicit PolledLines(MonotonicTime first_poll) : next_poll_(first_poll) {}
  void move(std::size_t input, bool is_high) { wires_.at(input) = is_high; }
  void run_to(MonotonicTime now) {
    if (now >= next_poll_) poll(now);
    if (now < read_.read_at + bus::kGpioReadPeriod && has_read_) return;
    has_read_ = true;
    read_ = {(wires_[0] ? 1U : 0U) | (wires_[1] ? 2U : 0U), now};
  }
  IoStatus next_edge(bus::GpioEdge& out) noexcept override {
    if (edges_.empty()) return IoStatus::NoData;
    out = edges_.front();
    edges_.pop_front();
    return IoStatus::Ok;
  }
  IoStatus levels(bus::GpioLevels& out) noexcept override {
    out = read_;
    return has_read_ ? IoStatus::Ok : IoStatus::NoData;
  }
  IoStatus set(std::size_t, bool) noexcept override { return IoStatus::Ok; }

 private:
  void poll(MonotonicTime now) {
    next_poll_ = next_poll_ + kPoll;
    for (std::uint8_t i = 0; i < 2; ++i) {
      if (told_.at(i) == wires_.at(i)) continue;
      told_.at(i) = wires_.at(i);
      edges_.push_back({i, wires_.at(i), now, ++sequences_.at(i)});
    }
  }
  std::array<bool, 2> wires_{};
  std::array<bool, 2> told_{};
  std::array<std::uint64_t, 2> sequences_{};
  std::deque<bus::GpioEdge> edges_;
  MonotonicTime next_poll_;
  bool has_read_{false};
  bus::GpioLevels read_{};
};

// At each phase of the poll, in milliseconds.
class PolledAdapter : public testing::TestWithParam<int> {
 protected:
  PolledAdapter() {
    run(milliseconds(300));
    EXPECT_TRUE(chain.reset());
  }
  void run(Duration duration) {
    for (Duration run{}; run < duration; run += milliseconds(1)) {
      now = now + milliseconds(1);
      lines.run_to(now);
      chain.step(&lines, now, [] { return true; });
      has_disagreed = has_disagreed || chain.status().trouble == ChainTrouble::Disagree;
    }
  }
  // The second contact moves so much later; contacts that are open are high.
  void turn(bool is_open, Duration apart) {
    lines.move(0, is_open);
    run(apart);
    lines.move(1, is_open);
  }

  MonotonicTime now{milliseconds(1000)};
  PolledLines lines{now + milliseconds(GetParam())};
  SafetyChain chain{{.estop_channels = 2}};
  bool has_disagreed{false};
};

TEST_P(PolledAdapter, ContactsThatMoveTogetherNeverDisagreeHoweverTheirEdgesAreTold) {
  for (const int apart_ms : {0, 2, 10, 25}) {
    turn(true, milliseconds(apart_ms));
    run(milliseconds(200));
    EXPECT_TRUE(chain.status().is_stopped);
    turn(false, milliseconds(apart_ms));
    run(milliseconds(200));
    EXPECT_FALSE(has_disagreed) << apart_ms << " ms apart";
    EXPECT_TRUE(chain.reset()) << apart_ms << " ms apart";
  }
}

TEST_P(PolledAdapter, AWeldedContactIsADefectUntilBothAreReadOpenTogether) {
  lines.move(0, true);
  run(milliseconds(100));
  lines.move(0, false);
  run(milliseconds(200));
  EXPECT_EQ(chain.status().trouble, ChainTrouble::Disagree);
  EXPECT_FALSE(chain.reset());
  turn(true, milliseconds(2));
  run(milliseconds(100));
  turn(false, milliseconds(2));
  run(milliseconds(200));
  EXPECT_TRUE(chain.reset());
}

TEST_P(PolledAdapter, APressThatOnlyOneReadingFindsHalfDoneIsNoDefect) {
  for (int i = 0; i < 20; ++i) {
    turn(true, milliseconds(15 + i));
    run(milliseconds(61));
    turn(false, milliseconds(15 + i));
    run(milliseconds(67));
  }
  EXPECT_FALSE(has_disagreed);
}

INSTANTIATE_TEST_SUITE_P(Phases, PolledAdapter, testing::Range(1, 56, 3));

}  // namespace
}  // namespace thimble::safety
