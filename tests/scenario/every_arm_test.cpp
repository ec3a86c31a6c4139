#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "sim/model/arm/arm_parameters.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"

// The same person, servo and wall with each arm of the family.
namespace thimble {
namespace {

std::vector<std::string> names_of_all() {
  std::vector<std::string> names;
  for (const sim::ArmParameters& arm : sim::all_arm_parameters()) names.emplace_back(arm.name);
  return names;
}

class EveryArm : public testing::TestWithParam<std::string> {
 protected:
  static std::vector<std::string> with(std::vector<std::string> more) {
    more.push_back("arm.0.device=sim:" + GetParam());
    return more;
  }
};

INSTANTIATE_TEST_SUITE_P(, EveryArm, testing::ValuesIn(names_of_all()), [](const auto& of) {
  std::string name = of.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '-' || c == '.'; }, '_');
  return name;
});

TEST_P(EveryArm, PushesBackFromAWallWithinItsLimitsAndLetsGoToZero) {
  test::ClosedLoop sut(with({"arm.hand.motion=still"}));
  test::ArmWatch watch(sut);
  ASSERT_TRUE(sut.run_until(6, [&] {
    watch.see();
    return sut.frame().gain >= 1;
  })) << to_string(sut.frame().state);
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 1e-3) << "driver and arm agree on the pose";

  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  sut.run(0.6, [&] { watch.see(); });
  EXPECT_TRUE(sut.frame().is_in_contact);
  EXPECT_LT(sut.frame().force.x, -1) << "away from the wall at +x";
  EXPECT_LT(sut.truth().motor_force.x, -1) << "and so do the motors";
  EXPECT_NEAR(norm(sut.frame().force - sut.truth().motor_force), 0, 0.3);

  sut.controls().want_active = false;
  ASSERT_TRUE(sut.run_until(0.5, [&] {
    watch.see();
    return sut.frame().state == OperatingState::Inactive;
  }));
  sut.run(0.01, [&] { watch.see(); });
  EXPECT_EQ(norm(sut.frame().force), 0);
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(EveryArm, AnEstopInContactStopsTheMotors) {
  test::ClosedLoop sut(with({"arm.hand.motion=still"}));
  sut.run_until_leaning();
  sut.controls().is_estop_healthy = false;
  sut.tick();
  EXPECT_EQ(norm(sut.frame().force), 0);
  sut.run(0.005);
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Estop);
}

TEST_P(EveryArm, ExploringTheBoxBreaksNoRule) {
  test::ClosedLoop sut(with({}));
  test::ArmWatch watch(sut);
  sut.run(12, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  EXPECT_GT(sut.snapshot().total_contacts, 0U);
}

TEST(Gimbal, TheStatusShowsTheStylusAsThePersonHoldsIt) {
  test::ClosedLoop sut({"arm.0.device=sim:polhem-1"});
  sut.run_until_driven();
  sut.sim_arm().backend().turn_stylus({0.3, -0.4, 2.5});
  double farthest_rad = 0;
  sut.run(8, [&] {
    const std::array<double, 3> truth_rad = sut.truth().gimbal_rad;
    const std::array<double, 3>& seen_rad = sut.snapshot().gimbal_rad;
    for (std::size_t i = 0; i < 3; ++i) {
      // Two encoder steps, and what the hand does within the two frames of an exchange.
      ASSERT_NEAR(seen_rad[i], truth_rad[i], 0.03);
    }
    farthest_rad = std::max(farthest_rad, std::abs(seen_rad[0] - 0.3));
  });
  EXPECT_GT(farthest_rad, 0.05) << "the waist turned under it";
}

}  // namespace
}  // namespace thimble
