#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"

// A puck in a whole session: it moves a probe in the world, and feels nothing.
namespace thimble {
namespace {

std::vector<std::string> puck(const std::string& motion) {
  return {"arm.0.device=sim:spacemouse", "arm.hand.motion=" + motion};
}

TEST(PuckSession, MovesAProbeThatTheWallsHoldBack) {
  test::ClosedLoop sut(puck("still"));
  ASSERT_TRUE(sut.run_until(5, [&] { return sut.frame().gain >= 1; }))
      << to_string(sut.frame().state) << ": " << sut.instruction();
  sut.sim_arm().backend().push_tip({20, 0, 0});
  sut.run(1.5);
  EXPECT_NEAR(sut.frame().tip.x, 0.1, 0.01) << "as far as the point goes";
  EXPECT_TRUE(sut.frame().is_in_contact);
  EXPECT_EQ(sut.snapshot().peak_force_newton, 0);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
}

TEST(PuckSession, AtRestItIsSilentAndThatIsNoFault) {
  test::ClosedLoop sut(puck("still"));
  sut.run_until_driven();
  sut.run(3);
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(sut.snapshot().missed_exchanges, 0U);
}

TEST(PuckSession, UnpluggedItIsLostAndComesBack) {
  test::ClosedLoop sut(puck("still"));
  sut.run_until_driven();
  sut.unplug();
  ASSERT_TRUE(sut.run_until(0.1, [&] { return sut.frame().state == OperatingState::Lost; }));
  sut.replug();
  ASSERT_TRUE(sut.run_until(5, [&] { return sut.frame().gain >= 1; }))
      << to_string(sut.frame().state) << ": what has no motors needs no clear";
  EXPECT_EQ(sut.snapshot().faults, 0U);
  EXPECT_EQ(sut.troubles().size(), 0U);
}

TEST(PuckSession, ExploringBreaksNoRule) {
  test::ClosedLoop sut(puck("explore"));
  test::ArmWatch watch(sut);
  sut.run(12, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_GT(sut.snapshot().total_contacts, 0U);
}

}  // namespace
}  // namespace thimble
