#include <gtest/gtest.h>

#include <chrono>
#include <utility>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using test::ArmWatch;
using test::ClosedLoop;

const std::vector<std::string> kStill{"arm.hand.motion=still"};

void stop(ClosedLoop& loop) {
  loop.controls().is_estop_healthy = false;
  loop.tick();
  ASSERT_EQ(loop.frame().state, OperatingState::Fault);
}

void clear(ClosedLoop& loop) { loop.controls().request_clear(loop.snapshot().fault.number); }

class FailSafe : public test::AtEachRate {};
THIMBLE_AT_EACH_RATE(FailSafe);

TEST_P(FailSafe, TheFirstFaultLatchesAndLaterOnesChangeNothing) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  stop(sut);
  const Fault first = sut.snapshot().fault;
  EXPECT_EQ(first.code, FaultCode::Estop);
  sut.tick(milliseconds(40));
  sut.controls().is_estop_healthy = true;
  sut.run(0.5);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Estop);
  EXPECT_EQ(sut.snapshot().fault.tick, first.tick);
  EXPECT_EQ(sut.snapshot().faults, 1U);
  EXPECT_EQ(sut.frame().state, OperatingState::Fault) << "a healthy input alone clears nothing";
}

TEST_P(FailSafe, ZeroThenSilenceAndTheWatchdogOfTheBoardTurnsTheAmplifierOff) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ASSERT_TRUE(sut.truth().is_amplifier_on);
  const MonotonicTime stopped = sut.now();
  stop(sut);
  MonotonicTime last_write{};
  MonotonicTime off_at{};
  sut.run(1, [&] {
    const servo::ServoFrame& frame = sut.frame();
    if (frame.write_status != IoStatus::NoData) last_write = frame.now;
    if (!sut.truth().is_amplifier_on && off_at == MonotonicTime{}) off_at = frame.now;
    if (frame.now - stopped > milliseconds(6)) {
      EXPECT_EQ(norm(sut.truth().motor_force), 0);
    }
  });
  EXPECT_NEAR(seconds(last_write - stopped), 0.1, 0.005);
  EXPECT_NEAR(seconds(off_at - last_write), 0.5, 0.006);
}

TEST_P(FailSafe, AClearNeedsHealthyInputsAndARisingEdgeAndThenTheForceRampsFromZero) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  stop(sut);
  clear(sut);
  sut.run(0.05, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Fault) << "the e-stop is still pressed";
  sut.controls().is_estop_healthy = true;
  sut.run(0.05, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Fault) << "the request was made before";

  clear(sut);
  ASSERT_TRUE(sut.run_until(0.1, [&] {
    watch.see();
    return sut.frame().state == OperatingState::Active;
  }));
  const MonotonicTime active_since = sut.now();
  sut.run(0.6, [&] {
    watch.see();
    const double since_s = seconds(sut.now() - active_since);
    EXPECT_LE(sut.frame().gain, since_s / 0.5 + 0.006);
    EXPECT_LE(norm(sut.truth().motor_force), 5 * since_s / 0.5 + 0.1);
  });
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  EXPECT_EQ(sut.frame().gain, 1);
  sut.sim_arm().backend().push_tip({6, 0, 0});
  sut.run(0.3, [&] { watch.see(); });
  EXPECT_GT(norm(sut.frame().force), 0.5) << "and the wall is felt again";
  EXPECT_EQ(watch.breach(), "");
}

// The board was silent for longer than its watchdog: it may have lost its counters.
TEST_P(FailSafe, AfterALongSilenceThePersonCalibratesAgainBeforeAnyForce) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  sut.sim_arm().backend().push_tip({});
  ArmWatch watch(sut);
  stop(sut);
  sut.controls().is_estop_healthy = true;
  sut.run(2, [&] { watch.see(); });
  clear(sut);
  ASSERT_TRUE(sut.run_until(0.1, [&] {
    watch.see();
    return sut.frame().calibration == CalibrationState::NeedsUser;
  }));
  EXPECT_NE(sut.instruction(), "");
  ASSERT_TRUE(sut.run_until(2, [&] {
    watch.see();
    return sut.frame().state == OperatingState::Active;
  }));
  EXPECT_EQ(sut.instruction(), "");
  sut.run(1, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(FailSafe, EveryStopLeavesARecordingOfTwoSecondsThatEndsWithTheFault) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  sut.run(2);
  EXPECT_FALSE(sut.arm().session().take_recording().has_value());
  stop(sut);
  const Fault fault = sut.snapshot().fault;
  sut.run(0.5);
  const std::optional<session::Recording> recording = sut.arm().session().take_recording();
  ASSERT_TRUE(recording.has_value());
  EXPECT_EQ(recording->header.fault.code, FaultCode::Estop);
  EXPECT_EQ(recording->header.fault.tick, fault.tick);
  const auto& frames = recording->frames;
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(2 * GetParam()));
  EXPECT_EQ(frames.back().fault, FaultCode::Estop);
  EXPECT_EQ(frames.back().tick, fault.tick);
  EXPECT_EQ(norm(frames.back().force), 0);
  EXPECT_GT(norm(frames[frames.size() - 2].force), 1);
  EXPECT_NE(servo::format_flight(recording->header, frames).find("estop"), std::string::npos);
  EXPECT_FALSE(sut.arm().session().take_recording().has_value()) << "once";
}

TEST_P(FailSafe, AnUnplugRightAfterAStopIsRecordedBesideIt) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  stop(sut);
  sut.unplug();
  sut.run(0.01);
  const std::optional<session::Recording> first = sut.arm().session().take_recording();
  const std::optional<session::Recording> second = sut.arm().session().take_recording();
  ASSERT_TRUE(first.has_value());
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ(first->header.fault.code, FaultCode::Estop);
  EXPECT_EQ(second->header.fault.code, FaultCode::Disconnected);
  EXPECT_EQ(second->frames.front().tick, first->frames.back().tick + 1) << "without a gap";
  EXPECT_EQ(second->frames.back().state, OperatingState::Lost);
  EXPECT_FALSE(sut.arm().session().take_recording().has_value());
}

}  // namespace
}  // namespace thimble
