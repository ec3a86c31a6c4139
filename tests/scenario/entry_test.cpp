#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "daemon/session/arm_instruction.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"

// Arms that are calibrated far outside of their world, as a WoodenHaptics is above its box.
namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

// Its person calibrates it there and brings it down.
TEST(OutsideItsWorld, AnArmThatIsWantedActiveHasNoForceUntilItIsBroughtIn) {
  ClosedLoop sut(
      {"arm.0.device=sim:woody-2015", "arm.hand.motion=still", "world.0.workspace_m=0.09"});
  ArmWatch watch(sut);
  const auto way = [&] { return session::way_in(sut.arm()); };
  std::string first;
  int kept_out = 0;
  ASSERT_TRUE(sut.run_until(10,
                            [&] {
                              watch.see();
                              if (sut.frame().state == OperatingState::Active) return true;
                              EXPECT_EQ(norm(sut.frame().force), 0);
                              EXPECT_EQ(norm(sut.truth().motor_force), 0);
                              kept_out += sut.snapshot().is_kept_out ? 1 : 0;
                              if (first.empty()) first = way();
                              return false;
                            }))
      << to_string(sut.frame().state) << ": " << way();
  EXPECT_TRUE(sut.controls().want_active);
  EXPECT_GT(kept_out, 100);
  EXPECT_EQ(first, "bring the arm into its world: 190 mm down, 10 mm farther");

  EXPECT_EQ(way(), "");
  EXPECT_LE(std::abs(sut.frame().tip.y), 0.035) << "of the cell in the middle, or 20 mm beside";
  EXPECT_EQ(sut.snapshot().peak_force_newton, 0) << "nothing was sent before";
  EXPECT_EQ(sut.snapshot().faults, 0U);
  sut.run(1, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(watch.breach(), "");
}

}  // namespace
}  // namespace thimble
