// Constraint planes (thesis 3.7.2), in whole sessions.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

TEST(ConstraintPlaneSession, EveryWorldIsFeltThroughIt) {
  const std::vector<std::vector<std::string>> worlds{
      {"world.source=box:3"},
      {"world.source=sphere"},
      {"world.source=pieces", "world.pieces.cells=32", "world.pieces.count=3"},
      {"world.source=life", "world.automaton.cells=32", "world.automaton.steps_per_s=2"}};
  for (const std::string walls : {"offset", "recovery"}) {
    for (const auto& world : worlds) {
      SCOPED_TRACE(walls + ", " + world.front());
      std::vector<std::string> said{"arm.coupling.scheme=constraint-plane",
                                    "arm.coupling.late_walls=" + walls, "arm.hand.reach_m=0.03",
                                    "arm.impairment.delay_s=0.05"};
      said.insert(said.end(), world.begin(), world.end());
      ClosedLoop sut(said);
      ArmWatch watch(sut);
      double hardest_newton = 0;
      double furthest_m = 0;
      sut.run(8, [&] {
        watch.see();
        hardest_newton = std::max(hardest_newton, norm(sut.frame().force));
        furthest_m = std::max(furthest_m, norm(sut.frame().offset));
      });
      EXPECT_EQ(watch.breach(), "");
      EXPECT_EQ(sut.snapshot().faults, 0U);
      EXPECT_GT(sut.snapshot().total_contacts, 0U);
      EXPECT_GT(hardest_newton, 0.3);
      EXPECT_EQ(furthest_m > 0, walls == "offset");
    }
  }
}

// A leaning slab on a floor and a ball beside it.
std::string of_shapes(const std::string& scheme) {
  return R"(
[[arm]]
name = "right"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
world = "corner"
coupling.scheme = ")" +
         scheme + R"("
[arm.hand]
motion = "explore"
reach_m = 0.03
[[world]]
name = "corner"
source = "shapes"
[[world.shape]]
kind = "floor"
center_m = [0, -0.020, 0]
[[world.shape]]
kind = "box"
center_m = [0.020, -0.010, 0]
rotation_rad = [0, 0, 0.5]
size_m = [0.010, 0.050, 0.060]
stiffness_newton_per_m = 400
[[world.shape]]
kind = "sphere"
center_m = [-0.015, -0.012, 0]
radius_m = 0.012
)";
}

// The most that the hand was given, J.
double expect_shapes_are_felt(const char* scheme, const std::string& guard) {
  ClosedLoop::Setup setup;
  setup.text = of_shapes(scheme);
  ClosedLoop sut({"arm.right.impairment.delay_s=0.02", "arm.right.coupling.passivity=" + guard},
                 setup);
  ArmWatch watch(sut);
  double hardest_newton = 0;
  double given_joule = 0;
  sut.run(8, [&] {
    watch.see();
    hardest_newton = std::max(hardest_newton, norm(sut.frame().force));
    given_joule = std::max(given_joule, sut.frame().wished_energy_j);
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.snapshot().faults, 0U);
  EXPECT_GT(sut.snapshot().total_contacts, 0U);
  EXPECT_GT(hardest_newton, 0.3);
  return given_joule;
}

TEST(Shapes, AreFeltThroughEverySchemeThatTakesThemAlsoThroughAGuard) {
  for (const char* scheme :
       {"ghost-point", "constraint-plane", "remote-force", "spring-damper", "wave"}) {
    SCOPED_TRACE(scheme);
    const double bare_joule = expect_shapes_are_felt(scheme, "false");
    EXPECT_LE(expect_shapes_are_felt(scheme, "true"), bare_joule);
  }
}

}  // namespace
}  // namespace thimble
