// A HID arm whose writes block, as hidraw's may for seconds. It is in lock-step with its host, and
// so its samples end, too, a little later: each exchange counts once.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using test::ArmWatch;
using test::ClosedLoop;

const std::vector<std::string> kStill{"arm.hand.motion=still"};

// Well after the arm leans on the wall.
constexpr MonotonicTime kTrouble{milliseconds(3000)};

sim::ScriptedFault blocked_write(MonotonicTime from, Duration lasts) {
  sim::ScriptedFault fault;
  fault.kind = sim::FaultKind::Stall;
  fault.from = from;
  fault.lasts = lasts;
  fault.endpoint = sim::kHidOut;
  return fault;
}

ClosedLoop::Setup cables_that(std::vector<sim::ScriptedFault> script) {
  ClosedLoop::Setup setup;
  setup.cables.script = std::move(script);
  return setup;
}

class BlockedWrite : public test::AtEachRate {
 protected:
  static void run_until_trouble(ClosedLoop& loop) {
    loop.run_until_leaning();
    ASSERT_TRUE(
        loop.run_until(3, [&] { return loop.now() + loop.settings().period() > kTrouble; }));
    ASSERT_GT(norm(loop.frame().force), 1);
    ASSERT_EQ(loop.snapshot().missed_exchanges, 0U) << "a healthy arm misses nothing";
  }
};
THIMBLE_AT_EACH_RATE(BlockedWrite);

TEST_P(BlockedWrite, CountsAsMissedExchangesAndStopsTheArmAfterTwentyMilliseconds) {
  constexpr Duration kBlock = milliseconds(300);
  ClosedLoop sut(with(kStill), cables_that({blocked_write(kTrouble, kBlock)}));
  run_until_trouble(sut);
  ASSERT_TRUE(sut.run_until(0.03, [&] { return sut.frame().state == OperatingState::Fault; }));
  EXPECT_LT(sut.now() - kTrouble, milliseconds(21) + 2 * sut.settings().period());
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::CommandTimeout);
  EXPECT_GE(sut.snapshot().missed_exchanges, test::exchanges_within(milliseconds(15), sut));
  EXPECT_LE(sut.snapshot().missed_exchanges, 20U);
  EXPECT_EQ(norm(sut.frame().force), 0);
  ASSERT_TRUE(sut.run_until(1, [&] { return sut.now() > kTrouble + kBlock + milliseconds(5); }));
  EXPECT_EQ(norm(sut.truth().motor_force), 0) << "what waited behind the block is a zero";
}

TEST_P(BlockedWrite, OftenAndShortLatchesMissedExchanges) {
  std::vector<sim::ScriptedFault> blocks;
  for (int i = 0; i < 20; ++i) {
    blocks.push_back(blocked_write(kTrouble + milliseconds(23 * i), milliseconds(15)));
  }
  ClosedLoop sut(with(kStill), cables_that(blocks));
  run_until_trouble(sut);
  ArmWatch watch(sut);
  ASSERT_TRUE(sut.run_until(0.3, [&] {
    watch.see();
    return sut.frame().state == OperatingState::Fault;
  }));
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::MissedExchanges);
  EXPECT_GT(sut.now(), kTrouble + milliseconds(23)) << "not by the first one";
  EXPECT_EQ(norm(sut.frame().force), 0);
  EXPECT_EQ(watch.breach(), "");
}

}  // namespace
}  // namespace thimble
