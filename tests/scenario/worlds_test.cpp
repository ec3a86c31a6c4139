#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/scenario/box_watch.hpp"
#include "tests/scenario/trace.hpp"

namespace thimble {
namespace {

using test::ArmWatch;
using test::BoxWatch;
using test::ClosedLoop;

const std::string kExamples = THIMBLE_EXAMPLES;

TEST(Worlds, ABoxOfFineCellsIsFeltNearAndFar) {
  for (const char* delay : {"0", "0.05"}) {
    ClosedLoop sut({"world.source=box:64", std::string("arm.impairment.delay_s=") + delay,
                    "arm.hand.reach_m=0.05", "arm.hand.speed_m_per_s=0.2"});
    BoxWatch watch(sut);
    sut.run(15, [&] { watch.see(); });
    EXPECT_EQ(watch.breach(), "");
    EXPECT_EQ(watch.pulls(), 0);
    EXPECT_EQ(sut.snapshot().faults, 0U);
    EXPECT_GT(sut.snapshot().total_contacts, 3U) << delay;
  }
}

TEST(Worlds, AVolumeFromANumPyFileIsFeltNearAndFar) {
  for (const char* delay : {"0", "0.05"}) {
    ClosedLoop sut({"world.source=" + kExamples + "/cave.npy",
                    std::string("arm.impairment.delay_s=") + delay, "arm.hand.reach_m=0.024"});
    ArmWatch watch(sut);
    sut.run(15, [&] { watch.see(); });
    EXPECT_EQ(watch.breach(), "");
    EXPECT_EQ(sut.snapshot().faults, 0U);
    EXPECT_GT(sut.snapshot().total_contacts, 5U) << delay;
    EXPECT_GT(sut.snapshot().peak_force_newton, 0.3) << delay;
  }
}

const std::vector<std::string> kOtherSeed = {"arm.right.hand.seed=9"};

// The arm of hello_text() with a second one before it.
std::string two_arms() {
  return R"(
[[arm]]
name = "left"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
world = "box"
[arm.hand]
motion = "explore"
seed = 1
)" + test::hello_text();
}

TEST(TwoArms, InOneWorldFeelItAsIfEachWereAlone) {
  ClosedLoop alone;
  ClosedLoop together(kOtherSeed, {two_arms(), {}, {}});
  ArmWatch left(together, 0);
  ArmWatch right(together, 1);
  sim::TraceHash of_alone;
  sim::TraceHash of_left;
  sim::TraceHash of_right;
  alone.run(10, [&] { test::add_to(of_alone, alone.frame()); });
  together.run(10, [&] {
    left.see();
    right.see();
    test::add_to(of_left, together.frame(0));
    test::add_to(of_right, together.frame(1));
  });
  EXPECT_EQ(left.breach(), "");
  EXPECT_EQ(right.breach(), "");
  EXPECT_EQ(of_left.value(), of_alone.value());
  EXPECT_NE(of_right.value(), of_left.value());
  EXPECT_GT(together.snapshot(0).total_contacts, 5U);
  EXPECT_GT(together.snapshot(1).total_contacts, 5U);
}

TEST(TwoArms, AStoppedArmLeavesTheOtherDriven) {
  ClosedLoop sut(kOtherSeed, {two_arms(), {}, {}});
  sut.run(3);
  sut.controls().is_estop_healthy = false;
  const std::uint64_t before = sut.snapshot(1).total_contacts;
  sut.run(5);
  EXPECT_EQ(sut.frame(0).state, OperatingState::Fault);
  EXPECT_EQ(sut.frame(1).state, OperatingState::Active);
  EXPECT_GT(sut.snapshot(1).total_contacts, before);
  EXPECT_EQ(sut.snapshot(1).faults, 0U);
}

TEST(ThesisLiteral, RunsInTheLoopAndTheLimiterBoundsIt) {
  ClosedLoop sut({"arm.coupling.scheme=thesis-literal", "arm.impairment.delay_s=0.1",
                  "arm.hand.reach_m=0.03", "arm.hand.stiffness_newton_per_m=600"});
  ArmWatch watch(sut);
  double largest_wish_newton = 0;
  sut.run(20, [&] {
    watch.see();
    largest_wish_newton = std::max(largest_wish_newton, norm(sut.frame().wish));
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_GT(sut.snapshot().total_contacts, 5U);
  EXPECT_GT(largest_wish_newton, sut.settings().limiter.max_force_newton)
      << "the printed client asks for too much; else this proves nothing";
}

TEST(ThesisLiteral, ItsForceFadesWhenTheWorldFallsSilent) {
  ClosedLoop sut({"arm.coupling.scheme=thesis-literal", "arm.hand.motion=still"});
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.set_network_up(false);
  sut.run(0.2, [&] { watch.see(); });
  EXPECT_GT(norm(sut.frame().force), 0.5);
  sut.run(0.3, [&] { watch.see(); });
  EXPECT_EQ(norm(sut.frame().force), 0);
  EXPECT_TRUE(sut.frame().is_fading);
  EXPECT_EQ(watch.breach(), "");
}

TEST(Worlds, AScanFromAnNrrdFileIsFelt) {
  ClosedLoop sut({"world.source=" + kExamples + "/scan.nhdr", "world.threshold=100",
                  "world.cell_m=0.0025", "arm.hand.reach_m=0.028"});
  ArmWatch watch(sut);
  sut.run(15, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.snapshot().faults, 0U);
  EXPECT_GT(sut.snapshot().total_contacts, 5U);
  EXPECT_GT(sut.snapshot().peak_force_newton, 0.3);
}

}  // namespace
}  // namespace thimble
