#include "drivers/spacemouse/pointer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace thimble::spacemouse {
namespace {

using std::chrono::milliseconds;
using Axes = std::array<std::int16_t, 3>;

class PointerTest : public testing::Test {
 protected:
  void run(Duration time, const Axes& push = {}) {
    for (Duration passed{}; passed < time; passed += milliseconds(1)) {
      now_ = now_ + milliseconds(1);
      sut_.push(push, now_);
      sut_.advance(now_);
    }
  }
  void be_silent(Duration time) {
    for (Duration passed{}; passed < time; passed += milliseconds(1)) {
      now_ = now_ + milliseconds(1);
      sut_.advance(now_);
    }
  }
  Pointer sut_{350};
  MonotonicTime now_{std::chrono::seconds(5)};
};

TEST_F(PointerTest, StartsAtItsCentreOnceThePuckWasLetGoForAWhile) {
  run(milliseconds(1));
  EXPECT_EQ(sut_.calibration(), CalibrationState::Unknown);
  run(milliseconds(300), {350, 0, 0});
  EXPECT_EQ(sut_.calibration(), CalibrationState::NeedsUser);
  EXPECT_EQ(sut_.position(), Position3{});
  run(Pointer::kSettle - milliseconds(1));
  EXPECT_NE(sut_.calibration(), CalibrationState::Ok);
  run(milliseconds(2));
  EXPECT_EQ(sut_.calibration(), CalibrationState::Ok);
}

TEST_F(PointerTest, MovesAsFastAndWhereThePuckIsPushed) {
  run(milliseconds(100));
  run(milliseconds(200), {350, 0, 0});
  EXPECT_NEAR(sut_.position().x, 0.03, 1e-9);
  run(milliseconds(200), {0, 350, 0});
  EXPECT_NEAR(sut_.position().z, 0.03, 1e-9) << "towards the person";
  run(milliseconds(200), {0, 0, 350});
  EXPECT_NEAR(sut_.position().y, -0.03, 1e-9) << "down";
  const Position3 before = sut_.position();
  run(milliseconds(500), {17, -17, 17});
  EXPECT_EQ(sut_.position(), before) << "within the dead band";
}

TEST_F(PointerTest, StandsStillWhenThePuckFallsSilent) {
  run(milliseconds(100));
  run(milliseconds(100), {350, 0, 0});
  be_silent(Pointer::kSilence + milliseconds(1));
  const Position3 stopped = sut_.position();
  EXPECT_NEAR(stopped.x, 0.03, 1e-9);
  be_silent(std::chrono::seconds(2));
  EXPECT_EQ(sut_.position(), stopped);
}

TEST_F(PointerTest, ForgetsWhereItIs) {
  run(milliseconds(100));
  run(milliseconds(100), {350, 0, 0});
  sut_.forget();
  EXPECT_EQ(sut_.calibration(), CalibrationState::Unknown);
  EXPECT_EQ(sut_.position(), Position3{});
}

TEST_F(PointerTest, NeverLeavesItsSphereNorOutrunsItsSpeedWhateverIsSaid) {
  std::mt19937 dice(2);
  for (int i = 0; i < 50000; ++i) {
    const Position3 before = sut_.position();
    const Duration step = milliseconds(static_cast<int>(dice() % 40)) - milliseconds(2);
    now_ = now_ + step;  // a clock that goes back moves nothing
    const Axes axes{static_cast<std::int16_t>(dice()), static_cast<std::int16_t>(dice()),
                    static_cast<std::int16_t>(dice())};
    if (dice() % 3 == 0) sut_.push(axes, now_);
    if (dice() % 50 == 0) sut_.push({}, now_);
    if (dice() % 500 == 0) sut_.turn(axes, now_);
    if (dice() % 100 == 0) sut_.turn({}, now_);
    sut_.advance(now_);
    const double most_m = std::sqrt(3.0) * Pointer::kFullSpeed_m_per_s *
                          seconds(std::clamp(step, Duration{}, Pointer::kLongestStep));
    ASSERT_LE(norm(sut_.position() - before), most_m + 1e-12);
    ASSERT_LE(norm(sut_.position() - Position3{}), Pointer::kRadius_m + 1e-12);
  }
  EXPECT_EQ(sut_.calibration(), CalibrationState::Ok);
}

}  // namespace
}  // namespace thimble::spacemouse
