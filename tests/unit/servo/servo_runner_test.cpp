#include "daemon/servo/servo_runner.hpp"

#include <gtest/gtest.h>

#include "tests/unit/servo/scripted_rig.hpp"

namespace thimble::servo {
namespace {

// A clock that ends the run after some sleeps, as the control thread would.
class StoppingClock final : public Clock {
 public:
  StoppingClock(HandClock& inner, std::atomic<bool>& stop, ServoControls& controls, int limit)
      : inner_(inner), stop_(stop), controls_(controls), left_(limit) {}
  [[nodiscard]] MonotonicTime now() const noexcept override { return inner_.now(); }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    ++sleeps;
    if (--left_ == 0) {
      controls_.want_active = false;
      stop_ = true;
    }
    return inner_.sleep_until(deadline);
  }

  int sleeps{0};

 private:
  HandClock& inner_;
  std::atomic<bool>& stop_;
  ServoControls& controls_;
  int left_;
};

TEST(ServoRunner, TicksOncePerPeriod) {
  ServoRig rig;
  std::atomic<bool> stop{false};
  StoppingClock clock(rig.clock, stop, rig.controls, 1000);
  const MonotonicTime begin = rig.clock.now();

  run_servo(rig.sut, clock, stop);

  EXPECT_EQ(rig.clock.now() - begin, clock.sleeps * rig.settings_.period());
}

TEST(ServoRunner, SkipsThePeriodsItMissedInsteadOfCatchingUp) {
  ServoRig rig;
  rig.clock.oversleep = std::chrono::microseconds(3500);
  std::atomic<bool> stop{false};
  StoppingClock clock(rig.clock, stop, rig.controls, 100);

  run_servo(rig.sut, clock, stop);

  EXPECT_EQ(rig.snapshot().frame.tick, static_cast<std::uint64_t>(clock.sleeps));
  EXPECT_GE(rig.snapshot().overruns, 3U * 100U);
}

TEST(ServoRunner, StoppingRampsTheForceToZeroAndSendsZero) {
  ServoRig rig;
  rig.coupling.wish = {4, 0, 0};
  rig.controls.want_active = true;
  std::atomic<bool> stop{false};
  StoppingClock clock(rig.clock, stop, rig.controls, 800);

  run_servo(rig.sut, clock, stop);

  const std::vector<Force3>& written = rig.device.written;
  ASSERT_GT(written.size(), 804U);
  for (std::size_t last = 1; last <= 5; ++last) {
    EXPECT_EQ(written[written.size() - last], Force3{}) << "zero for 5 ms";
  }
  EXPECT_NEAR(written[797].x, 4, 1e-9);
  EXPECT_GT(written[804].x, 0) << "a ramp, not a cut";
  EXPECT_LE(clock.sleeps, 800 + 30);
}

// Zero force on every exit: not only where somebody remembered to withdraw the wish to drive.
TEST(ServoRunner, StoppingEndsInZeroThoughTheControlsStillWantForce) {
  ServoRig rig;
  rig.coupling.wish = {4, 0, 0};
  rig.controls.want_active = true;
  ServoControls unheard;
  std::atomic<bool> stop{false};
  StoppingClock clock(rig.clock, stop, unheard, 800);

  run_servo(rig.sut, clock, stop);

  const std::vector<Force3>& written = rig.device.written;
  ASSERT_GT(written.size(), 804U);
  for (std::size_t last = 1; last <= 5; ++last) {
    EXPECT_EQ(written[written.size() - last], Force3{}) << "zero for 5 ms";
  }
  EXPECT_GT(written[804].x, 0) << "a ramp, not a cut";
  EXPECT_LE(clock.sleeps, 800 + 30);
}

TEST(ServoRunner, CountsThePeriodsThatPassedWithinATick) {
  ServoRig rig;
  rig.device.on_write = [&] { rig.clock.advance(std::chrono::microseconds(2500)); };
  std::atomic<bool> stop{false};
  StoppingClock clock(rig.clock, stop, rig.controls, 100);

  run_servo(rig.sut, clock, stop);

  EXPECT_GE(rig.snapshot().overruns, 100U);
  EXPECT_LE(rig.snapshot().overruns, 300U);
}

}  // namespace
}  // namespace thimble::servo
