#include "cli/calibrate_force.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <random>

namespace thimble::cli {
namespace {

using testing::HasSubstr;

api::ArmStatus falcon() {
  api::ArmStatus arm;
  arm.name = "right";
  arm.state = "inactive";
  arm.newton_per_count = 0.0175;
  arm.max_force_newton = 10;
  return arm;
}

TEST(StrongestForce, IsFourHundredCountsUnlessAPersonSaysMore) {
  EXPECT_DOUBLE_EQ(strongest_force_newton(falcon(), {}).value(), 7);
  EXPECT_DOUBLE_EQ(strongest_force_newton(falcon(), {.most_newton = 8}).value(), 8);
  api::ArmStatus strong = falcon();
  strong.newton_per_count = 1;
  EXPECT_DOUBLE_EQ(strongest_force_newton(strong, {}).value(), 8);
}

TEST(StrongestForce, IsNeverOneThatTheLimiterCutsDown) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> limit(0.1, 10);
  for (int i = 0; i < 1000; ++i) {
    api::ArmStatus arm = falcon();
    arm.max_force_newton = limit(random);
    const auto sut = strongest_force_newton(arm, {});
    ASSERT_EQ(sut.has_value(), arm.max_force_newton >= 7) << arm.max_force_newton;
    if (sut) continue;
    EXPECT_THAT(sut.error().message, HasSubstr("arm.limits.force_newton"));
    // What --most would not take is not offered.
    EXPECT_EQ(sut.error().message.find("its direction only, give --most") != std::string::npos,
              arm.max_force_newton >= 0.5);
  }
}

TEST(StrongestForce, IsNotAskedOfAnArmThatIsLostBeforeAnythingElse) {
  api::ArmStatus arm;
  arm.name = "right";
  arm.state = "lost";
  arm.instruction = "usb:X is gone";
  const auto sut = strongest_force_newton(arm, {});
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().message, "arm right is lost: usb:X is gone");
}

TEST(StrongestForce, TellsAnArmWithoutMotorsFromOneThatIsToldAmperes) {
  api::ArmStatus arm = falcon();
  arm.newton_per_count = 0;
  EXPECT_THAT(strongest_force_newton(arm, {}).error().message, HasSubstr("told amperes"));
  arm.max_force_newton = 0;
  EXPECT_THAT(strongest_force_newton(arm, {}).error().message, HasSubstr("makes no force"));
}

TEST(StrongestForce, OfADaemonThatTellsNoLimitIsNotRefused) {
  api::ArmStatus arm = falcon();
  arm.max_force_newton = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(strongest_force_newton(arm, {}));
}

TEST(ATrial, IsWhatAsksForLessThanTheDefault) {
  for (const double most_newton : {0.5, 1.0, 5.0, 6.9}) {
    EXPECT_TRUE(is_trial(falcon(), {.most_newton = most_newton})) << most_newton;
  }
  EXPECT_FALSE(is_trial(falcon(), {}));
  EXPECT_FALSE(is_trial(falcon(), {.most_newton = 7}));
  EXPECT_FALSE(is_trial(falcon(), {.most_newton = 8}));
}

// A measured arm is asked for as many counts by fewer newtons.
TEST(ATrial, GoesByCountsNotByNewtons) {
  api::ArmStatus arm = falcon();
  arm.newton_per_count = 0.00244;
  EXPECT_FALSE(is_trial(arm, {.most_newton = 1}));
  EXPECT_TRUE(is_trial(arm, {.most_newton = 0.9}));
  EXPECT_FALSE(is_trial(arm, {})) << "below a newton, and yet 400 counts";
}

}  // namespace
}  // namespace thimble::cli
