#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

bool is_without_current(const plugin::ArmTruth& truth) {
  return std::all_of(truth.motor_current_a.begin(), truth.motor_current_a.end(),
                     [](double a) { return a == 0; });
}

class Calibration : public test::AtEachRate {};
THIMBLE_AT_EACH_RATE(Calibration);

TEST_P(Calibration, ThePersonDoesWhatTheInstructionSaysAndOnlyThenTheArmIsDriven) {
  ClosedLoop sut(with());
  ASSERT_TRUE(sut.run_until(2, [&] {
    const bool is_calibrated = sut.frame().calibration == CalibrationState::Ok;
    EXPECT_EQ(sut.instruction().empty(), is_calibrated);
    if (!is_calibrated) {
      EXPECT_TRUE(is_without_current(sut.truth()));
      EXPECT_NE(sut.frame().state, OperatingState::Active);
    }
    return sut.frame().state == OperatingState::Active;
  }));
  EXPECT_GT(seconds(sut.now().since_epoch), 0.55) << "not before the button was pressed";
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 0.5e-3);
}

// Dragged through every wall of the world by an arm that nobody calibrated.
TEST_P(Calibration, AnArmThatNobodyCalibratesNeverGetsCurrentWhateverTheWorldSays) {
  ClosedLoop sut(with({"arm.coupling.stiffness_newton_per_m=20000"}));
  ArmWatch watch(sut);
  sut.sim_arm().backend().hold_tip(nullptr);
  for (const double push_newton : {8.0, -8.0, 0.0}) {
    sut.sim_arm().backend().push_tip({push_newton, push_newton / 2, 0});
    sut.run(1, [&] {
      watch.see();
      EXPECT_TRUE(is_without_current(sut.truth()));
      EXPECT_NE(sut.frame().state, OperatingState::Active);
    });
    EXPECT_EQ(sut.frame().state, OperatingState::Calibrating);
    EXPECT_NE(sut.instruction(), "");
  }
  EXPECT_EQ(watch.breach(), "");
}

}  // namespace
}  // namespace thimble
