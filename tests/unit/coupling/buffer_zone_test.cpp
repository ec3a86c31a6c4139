#include "daemon/coupling/buffer_zone_arm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "daemon/coupling/tell.hpp"
#include "daemon/coupling/wall_penalty.hpp"
#include "daemon/world/ghost_motion.hpp"
#include "hand_samples.hpp"
#include "turned_world.hpp"
#include "zone_hand.hpp"
#include "zoned.hpp"

namespace thimble::coupling {
namespace {

using testing::between;
using testing::cells_at_random;
using testing::delayed_by;
using testing::kTick;
using testing::middle_of;
using testing::room_at_random;
using testing::Zoned;
using testing::ZoneHand;
using world::Cell;
using world::VoxelGrid;

const ToolProperties kTool = BufferZoneSettings{}.tool;

// What is felt without any delay, worked out with the whole grid.
struct Undelayed {
  Undelayed(VoxelGrid the_grid, Position3 at, Cell cell)
      : grid(std::move(the_grid)), ghost{{at, cell}} {}

  Force3 feel(Position3 tip, Velocity3 velocity, Duration dt) {
    return wall_penalty(planes_of(move_ghost(grid, ghost, tip, dt)), kTool, tip, velocity);
  }

  VoxelGrid grid;
  world::GhostState ghost;
};

struct ZoneCourse {
  VoxelGrid grid;
  Cell start{};
  ZoneNames names{};
  double most_m_per_s{0.3};
  double delay_s{0};
  double buffer_m{0};
  int rate_hz{1000};
  link::ImpairmentSettings link{};
};

struct Compared {
  int ticks_felt{0};
  int ticks_that_differ{0};
  std::uint64_t corrections{0};
};

// The same hand on the scheme and without any delay.
Compared compare(const ZoneCourse& course, std::uint64_t seed) {
  const Duration dt = from_seconds(1.0 / course.rate_hz);
  Zoned sut(course.grid, {.buffer_m = course.buffer_m, .names = course.names}, dt, course.link);
  const Position3 start = middle_of(course.grid, course.start);
  Undelayed undelayed(course.grid, start, course.start);
  ZoneHand hand(seed, start, course.most_m_per_s);
  sut.rest(start, 2 * course.delay_s + 0.3);
  Compared out;
  for (double t = 0; t < 3; t += seconds(dt)) {
    hand.move(undelayed.ghost.point.position, dt);
    const Force3 expected = undelayed.feel(hand.at(), hand.velocity(), dt);
    const ArmOutput felt = sut.loop.tick(hand.at(), hand.velocity());
    if (expected != Force3{}) ++out.ticks_felt;
    if (felt.force != expected) ++out.ticks_that_differ;
    EXPECT_EQ(felt.offset, Displacement3{});
  }
  out.corrections = sut.arm.corrections();
  return out;
}

// teleop.md 2(d): with v <= v_max bit-identical to undelayed.
TEST(BufferZone, NamingCellsIsFeltAsWithoutDelayBitForBitInAnyWorld) {
  std::mt19937_64 random(610);
  int felt = 0;
  for (std::uint64_t run = 0; run < 60; ++run) {
    ZoneCourse course{.grid = cells_at_random(random, between(random, 0.02, 0.04)),
                      .start = {4, 4, 3},
                      .names = ZoneNames::Cells};
    course.delay_s = between(random, 0, 0.1);
    course.rate_hz = std::array{500, 1000, 2000, 4000}[run % 4];
    course.link = delayed_by(course.delay_s);
    course.buffer_m = course.most_m_per_s * (course.delay_s + 1.0 / course.rate_hz);
    const Compared found = compare(course, run);
    EXPECT_EQ(found.ticks_that_differ, 0) << run;
    EXPECT_EQ(found.corrections, 0U) << run;
    felt += found.ticks_felt;
  }
  EXPECT_GT(felt, 50'000);
}

TEST(BufferZone, InARoomFacesDoAsWellAlsoUnderJitterAndLoss) {
  std::mt19937_64 random(611);
  int felt = 0;
  for (std::uint64_t run = 0; run < 40; ++run) {
    ZoneCourse course{.grid = room_at_random(random, between(random, 0.003, 0.01)),
                      .start = {5, 5, 5},
                      .names = run % 2 == 0 ? ZoneNames::Faces : ZoneNames::Cells};
    course.delay_s = between(random, 0, 0.1);
    course.rate_hz = std::array{500, 1000, 2000, 4000}[run % 4];
    course.link = {.delay_s = course.delay_s,
                   .jitter_s = course.delay_s / 4,
                   .loss = 0.05,
                   .duplicate = 0.02,
                   .reorder = 0.02,
                   .seed = run};
    course.buffer_m = course.most_m_per_s * (2 * course.delay_s + 30.0 / course.rate_hz);
    const Compared found = compare(course, run);
    EXPECT_EQ(found.ticks_that_differ, 0) << run;
    felt += found.ticks_felt;
  }
  EXPECT_GT(felt, 50'000);
}

TEST(BufferZone, MirroredAndPermutedWorldsGiveMirroredAndPermutedForces) {
  std::mt19937_64 random(612);
  for (std::uint64_t run = 0; run < 4; ++run) {
    const VoxelGrid grid = testing::cells_round_the_origin(random);
    for (const ZoneNames names : {ZoneNames::Cells, ZoneNames::Faces}) {
      const auto feel = [&](const VoxelGrid& turned, const world::Symmetry& turn) {
        Zoned sut(turned, {.buffer_m = 0.025, .names = names}, kTick, delayed_by(0.08));
        sut.rest({}, 0.4);
        ZoneHand hand(run, {}, 0.4);
        Undelayed person(grid, {}, testing::kCellOfTheOrigin);
        testing::TurnedTrace trace;
        for (int i = 0; i < 2000; ++i) {
          hand.move(person.ghost.point.position, kTick);
          (void)person.feel(hand.at(), hand.velocity(), kTick);
          trace.emplace_back(turn,
                             sut.loop.tick(image(turn, hand.at()), image(turn, hand.velocity())));
        }
        EXPECT_GT(testing::ticks_felt(trace), 100);
        return trace;
      };
      testing::expect_turned_cells_are_felt_turned(grid, feel, 0);
    }
  }
}

}  // namespace
}  // namespace thimble::coupling
