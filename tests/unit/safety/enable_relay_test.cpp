#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <utility>

#include "daemon/safety/safety_chain.hpp"
#include "hal/bus/gpio_mailboxes.hpp"

// The relay of docs/safety-wiring.md behind a chip that takes its time, millisecond by millisecond.
namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

// Charged by each rise, it falls 78 ms after the last.
constexpr Duration kHold = milliseconds(78);

class RelayBench {
 public:
  explicit RelayBench(bool has_lamp)
      : chain({.estop_channels = 1, .has_enable = true, .has_lamp = has_lamp}),
        mail_(1, has_lamp ? 2 : 1, nullptr) {}

  // One ms; `is_looked_after`: the chain's thread may step if it is due.
  void tick(bool is_looked_after = true) {
    now_ = now_ + milliseconds(1);
    serve_chip();
    if (!is_looked_after || now_ < next_step_) return;
    next_step_ = now_ + milliseconds(5);
    mail_.deliver_levels({0, now_});
    chain.step(&mail_, now_, [this] { return has_beaten; });
  }
  void run(Duration duration) {
    for (Duration run{}; run < duration; run += milliseconds(1)) tick();
  }
  bool start() {
    run(milliseconds(100));
    const bool is_free = chain.reset();
    rose_at_.reset();
    return is_free;
  }

  SafetyChain chain;
  Duration latency{milliseconds(8)};  // of a write
  bool has_beaten{true};
  int closed_again{0};  // under arms that are driven

 private:
  void serve_chip() {
    if (!writing_) {
      writing_ = mail_.wanted();
      done_at_ = now_ + latency;
    }
    if (!writing_ || now_ < done_at_) return;
    const bool is_high = (writing_->high & 1U) != 0;
    if (is_high && !is_high_) rise();
    is_high_ = is_high;
    mail_.written(*std::exchange(writing_, std::nullopt));
  }
  void rise() {
    const bool had_fallen = rose_at_ && now_ - *rose_at_ > kHold;
    if (had_fallen && !chain.status().is_stopped) ++closed_again;
    rose_at_ = now_;
  }

  bus::GpioMailboxes mail_;
  MonotonicTime now_{std::chrono::seconds(1)};
  MonotonicTime next_step_{};
  std::optional<bus::GpioWish> writing_;
  MonotonicTime done_at_{};
  bool is_high_{false};
  std::optional<MonotonicTime> rose_at_;
};

TEST(EnableRelay, IsHeldByAChipThatNeedsUpTo25MillisecondsForEachWrite) {
  for (const bool has_lamp : {false, true}) {
    for (int ms = 0; ms <= 25; ++ms) {
      RelayBench sut(has_lamp);
      sut.latency = milliseconds(ms);
      ASSERT_TRUE(sut.start());
      sut.run(milliseconds(5000));
      EXPECT_FALSE(sut.chain.status().is_stopped) << ms;
      EXPECT_EQ(sut.closed_again, 0) << ms;
    }
  }
}

TEST(EnableRelay, AChipThatIsTooSlowForItIsAStop) {
  for (int ms = 40; ms <= 120; ms += 5) {
    RelayBench sut(true);
    ASSERT_TRUE(sut.start());
    sut.latency = milliseconds(ms);
    sut.run(milliseconds(500));
    EXPECT_TRUE(sut.chain.status().is_stopped) << ms;
    EXPECT_EQ(sut.closed_again, 0) << ms;
  }
}

// For so long that it falls, or not: whenever it closes again, nothing is driven.
TEST(EnableRelay, AHangOfAnyLengthAtAnyMomentIsAStopBeforeItClosesAgain) {
  int stops = 0;
  for (int hang_ms = 5; hang_ms <= 150; ++hang_ms) {
    for (int phase_ms = 0; phase_ms < 40; ++phase_ms) {
      RelayBench sut(true);
      ASSERT_TRUE(sut.start());
      sut.run(milliseconds(200 + phase_ms));
      sut.latency = milliseconds(hang_ms);
      sut.run(milliseconds(hang_ms));
      sut.latency = milliseconds(8);
      sut.run(milliseconds(400));
      ASSERT_EQ(sut.closed_again, 0) << hang_ms << " ms at " << phase_ms;
      if (hang_ms <= 20) {
        ASSERT_FALSE(sut.chain.status().is_stopped) << hang_ms << " ms at " << phase_ms;
      }
      if (hang_ms >= 80) {
        ASSERT_TRUE(sut.chain.status().is_stopped) << hang_ms << " ms at " << phase_ms;
      }
      stops += sut.chain.status().is_stopped ? 1 : 0;
    }
  }
  EXPECT_GT(stops, 1000);
}

TEST(EnableRelay, NeverClosesAgainUnderArmsThatAreDrivenWhateverServosAndChipDo) {
  std::mt19937 random(5);
  int stops = 0;
  for (int round = 0; round < 400; ++round) {
    RelayBench sut(round % 2 == 0);
    ASSERT_TRUE(sut.start());
    for (int ms = 0; ms < 3000; ++ms) {
      if (random() % 50 == 0) sut.has_beaten = random() % 4 != 0;
      if (random() % 20 == 0)
        sut.latency = milliseconds(random() % 20 == 0 ? random() % 70 : random() % 15);
      sut.tick();
      ASSERT_EQ(sut.closed_again, 0) << round << " at " << ms;
    }
    stops += sut.chain.status().is_stopped ? 1 : 0;
  }
  EXPECT_GT(stops, 50);
}

// While nobody looks nothing is put; what the chip still had to write is the one rise that may
// come.
TEST(EnableRelay, AThreadThatComesBackStopsBeforeItBeats) {
  for (int late_ms = 5; late_ms <= 300; ++late_ms) {
    RelayBench sut(true);
    sut.latency = milliseconds(3);
    ASSERT_TRUE(sut.start());
    sut.run(milliseconds(211));
    for (int i = 0; i < late_ms; ++i) sut.tick(false);
    sut.run(milliseconds(200));
    ASSERT_EQ(sut.closed_again, 0) << late_ms;
    if (late_ms > 80) {
      ASSERT_TRUE(sut.chain.status().is_stopped) << late_ms;
    }
  }
}

}  // namespace
}  // namespace thimble::safety
