#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "daemon/world/cam/live_world.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"

// Worlds that run while they are touched (thesis 5.4.1): what grows or dies under a finger breaks
// none of the rules that the arm is held to.
namespace thimble {
namespace {

using test::ClosedLoop;

ClosedLoop loop_in(const std::string& source, const std::vector<std::string>& more) {
  std::vector<std::string> said{"world.source=" + source, "arm.hand.reach_m=0.03",
                                "arm.hand.speed_m_per_s=0.15"};
  said.insert(said.end(), more.begin(), more.end());
  return ClosedLoop(said);
}

void expect_no_breach(ClosedLoop& loop, double for_s, std::uint64_t least_contacts) {
  loop.run_until_driven();
  test::ArmWatch watch(loop);
  world::cam::LiveWorld& world = *loop.world().live();
  const std::uint64_t steps = world.steps();
  int ticks = 0;
  constexpr world::ProbeId kArmsProbe{1};  // the world's first
  loop.run(for_s, [&] {
    watch.see();
    // A hole, or matter, around the finger, ten times a second.
    if (++ticks % 100 == 0) world.press(kArmsProbe, ticks % 300 == 0 ? 2 : 1);
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(loop.snapshot().faults, 0U);
  EXPECT_GT(world.steps(), steps);
  EXPECT_EQ(world.left_out(), 0U);
  EXPECT_GE(loop.snapshot().total_contacts, least_contacts);
  std::printf("%llu steps, %zu cells of matter, contacts %llu, peak %.2f N\n",
              static_cast<unsigned long long>(world.steps()), world.occupied_cells(),
              static_cast<unsigned long long>(loop.snapshot().total_contacts),
              watch.peak_sent_newton());
}

TEST(LiveWorldUnderTheHand, LifeBreaksNoRuleAtAnyPace) {
  for (const char* pace : {"10", "200"}) {
    SCOPED_TRACE(pace);
    ClosedLoop loop = loop_in(
        "life", {"world.automaton.cells=64", std::string("world.automaton.steps_per_s=") + pace});
    expect_no_breach(loop, 10, 50);
  }
}

TEST(LiveWorldUnderTheHand, ACrystalGrowsOverTheFingerAndBreaksNoRule) {
  ClosedLoop loop =
      loop_in("crystal", {"world.automaton.axes=3", "world.automaton.cells=32",
                          "world.automaton.fill_fraction=0.1", "world.automaton.steps_per_s=50"});
  expect_no_breach(loop, 10, 20);
  EXPECT_GT(loop.world().occupied_cells(), 500U);
}

// The same seed and the same hand: the same world.
TEST(LiveWorldUnderTheHand, IsTheSameEachTime) {
  const auto play = [] {
    ClosedLoop loop = loop_in("crystal", {"world.automaton.cells=64"});
    loop.run_until_driven();
    loop.run(3, [] {});
    return std::pair{loop.world().live()->save(), loop.frame().tip};
  };
  EXPECT_EQ(play(), play());
}

}  // namespace
}  // namespace thimble
