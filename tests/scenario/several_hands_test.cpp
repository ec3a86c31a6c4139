// Several arms in one world (thesis 5.2, 5.3.4), in whole sessions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

using test::ClosedLoop;

// Two hands at rest on both sides of a block, each with a frame of its own.
std::string hands_and_block(const std::string& scheme) {
  const auto arm = [&](const std::string& name, const std::string& place) {
    return "[[arm]]\nname = \"" + name +
           "\"\ndevice = \"sim:phantom-vintage\"\namplifier_max_a = 3.0\nworld = \"room\"\n"
           "place_m = " +
           place + "\n[arm.hand]\nmotion = \"still\"\nstiffness_newton_per_m = 100\n" +
           "[arm.coupling]\nscheme = \"" + scheme + "\"\n";
  };
  return arm("left", "[-0.03, 0, 0]") + arm("right", "[0.03, 0, 0]") +
         "[[world]]\nname = \"room\"\nsource = \"block\"\n";
}

ClosedLoop::Setup with(const std::string& text) {
  ClosedLoop::Setup setup;
  setup.text = text;
  return setup;
}

double block_x_m(ClosedLoop& loop) { return loop.world().block_center()->x; }

class TwoHands : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(, TwoHands, testing::Values("ghost-point", "constraint-plane"),
                         [](const auto& of) {
                           return std::string(of.param == "ghost-point" ? "GhostPoint"
                                                                        : "ConstraintPlane");
                         });

TEST_P(TwoHands, SqueezeABlockThatBothFeelAndNoneMoves) {
  ClosedLoop sut({}, with(hands_and_block(GetParam())));
  sut.run_until_driven();
  sut.sim_arm(0).backend().push_tip({4, 0, 0});
  sut.sim_arm(1).backend().push_tip({-4, 0, 0});
  sut.run(3);
  EXPECT_TRUE(sut.frame(0).is_in_contact);
  EXPECT_TRUE(sut.frame(1).is_in_contact);
  EXPECT_LT(sut.frame(0).force.x, -0.5);
  EXPECT_GT(sut.frame(1).force.x, 0.5);
  EXPECT_NEAR(sut.frame(0).force.x, -sut.frame(1).force.x, 0.3);
  EXPECT_NEAR(block_x_m(sut), 0, 2e-3);
  EXPECT_EQ(sut.snapshot(0).faults + sut.snapshot(1).faults, 0U);
}

TEST_P(TwoHands, TheStrongerOneMovesTheBlockAndTheOther) {
  ClosedLoop sut({}, with(hands_and_block(GetParam())));
  sut.run_until_driven();
  sut.sim_arm(1).backend().push_tip({-1.5, 0, 0});
  sut.run(1);
  const double before_m = sut.frame(1).tip.x + sut.frame(1).offset.x;
  const double rest_m = block_x_m(sut);
  sut.sim_arm(0).backend().push_tip({5, 0, 0});
  sut.run(4);
  EXPECT_GT(block_x_m(sut), rest_m + 3e-3);
  EXPECT_TRUE(sut.frame(1).is_in_contact);
  EXPECT_GT(sut.frame(1).tip.x + sut.frame(1).offset.x, before_m + 2e-3)
      << "the hand in the world goes with the block";
  EXPECT_GT(sut.frame(1).force.x, 0.1) << "and is pushed";
}

// A hand at rest that another's block comes to.
TEST_P(TwoHands, AHandThatOnlyWaitsIsPushedByWhatAnotherPushes) {
  ClosedLoop sut({}, with(hands_and_block(GetParam())));
  sut.run_until_driven();
  sut.run(0.5);
  ASSERT_FALSE(sut.frame(1).is_in_contact);
  sut.sim_arm(0).backend().push_tip({6, 0, 0});
  double most_newton = 0;
  const bool was_met = sut.run_until(6, [&] { return sut.frame(1).is_in_contact; });
  EXPECT_TRUE(was_met);
  sut.run(2, [&] { most_newton = std::max(most_newton, sut.frame(1).force.x); });
  EXPECT_GT(most_newton, 0.1);
  EXPECT_EQ(sut.snapshot(1).faults, 0U);
}

TEST_P(TwoHands, EachHasAFrameAndAGhostOfItsOwn) {
  ClosedLoop sut({"arm.left.impairment.delay_s=0.05"}, with(hands_and_block(GetParam())));
  sut.run_until_driven();
  sut.sim_arm(0).backend().push_tip({6, 0, 0});
  sut.run(1);
  EXPECT_GT(norm(sut.frame(0).offset), 1e-3);
  EXPECT_EQ(sut.frame(1).offset, Displacement3{});
  ASSERT_TRUE(sut.snapshot(0).felt.has_ghost);
  ASSERT_TRUE(sut.snapshot(1).felt.has_ghost);
  EXPECT_NEAR(sut.snapshot(1).felt.ghost.x, sut.frame(1).tip.x, 1e-3) << "in its own frame";
}

// Two that squeeze a block of 0.5 N that stands on the floor, and then go up (thesis 5.2).
struct Lift {
  double block_m{0};      // that it rose
  double felt_newton{0};  // the most that pulled the left hand down
  std::uint64_t faults{0};
};

Lift lift(const std::string& scheme, double friction, double delay_s) {
  ClosedLoop sut({"arm.left.impairment.delay_s=" + std::to_string(delay_s),
                  "arm.right.impairment.delay_s=" + std::to_string(delay_s)},
                 with(hands_and_block(scheme) + "[world.block]\nedge_m = 0.05\nfriction = " +
                      std::to_string(friction) + "\nweight_newton = [0, -0.5, 0]\n"));
  sut.run_until_driven();
  double push_newton = 0;  // gently: a hand that meets a late wall shifts its frame, and leans less
  sut.run(2, [&] {
    push_newton = std::min(4.0, push_newton + 0.004);
    sut.sim_arm(0).backend().push_tip({push_newton, 0, 0});
    sut.sim_arm(1).backend().push_tip({-push_newton, 0, 0});
  });
  const double before_m = sut.world().block_center()->y;
  sut.sim_arm(0).backend().push_tip({4, 1, 0});
  sut.sim_arm(1).backend().push_tip({-4, 1, 0});
  Lift seen;
  sut.run(2, [&] { seen.felt_newton = std::max(seen.felt_newton, -sut.frame(0).force.y); });
  seen.block_m = sut.world().block_center()->y - before_m;
  seen.faults = sut.snapshot(0).faults + sut.snapshot(1).faults;
  return seen;
}

class TwoFingersLift : public TwoHands {};
INSTANTIATE_TEST_SUITE_P(, TwoFingersLift, testing::Values("ghost-point", "constraint-plane"),
                         [](const auto& of) {
                           return std::string(of.param == "ghost-point" ? "GhostPoint"
                                                                        : "ConstraintPlane");
                         });

TEST_P(TwoFingersLift, ABlockAgainstItsWeightAndFeelIt) {
  for (const double delay_s : {0.0, 0.05}) {
    const Lift both = lift(GetParam(), 0.6, delay_s);
    EXPECT_GT(both.block_m, 3e-3) << delay_s;
    EXPECT_GT(both.felt_newton, 0.1) << delay_s;
    EXPECT_EQ(both.faults, 0U);
  }
  EXPECT_EQ(lift(GetParam(), 0, 0).block_m, 0) << "a smooth one stays where it is";
}

}  // namespace
}  // namespace thimble
