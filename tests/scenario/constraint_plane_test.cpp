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

}  // namespace
}  // namespace thimble
