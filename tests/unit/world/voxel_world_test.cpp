#include "daemon/world/voxel_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);

VoxelWorld box() { return VoxelWorld(make_box(3).value(), "box:3"); }

TEST(VoxelWorld, TellsWhatItIs) {
  const VoxelWorld sut(empty_grid({2, 4, 8}, 0.01), "volume.npy");
  EXPECT_EQ(sut.info().source, "volume.npy");
  EXPECT_EQ(sut.info().cells, (std::array<std::uint32_t, 3>{2, 4, 8}));
  EXPECT_DOUBLE_EQ(sut.info().cell_m, 0.01);
  EXPECT_DOUBLE_EQ(sut.info().extent_m[2], 0.08);
}

TEST(VoxelWorld, StartsTheGhostAtAFreeHand) {
  VoxelWorld sut = box();
  const Position3 hand{0.003, -0.002, 0.014};
  const ProbeId probe = sut.add_probe(hand).value();
  const ProbeMotion motion = sut.move_probe(probe, hand, kTick);
  EXPECT_EQ(motion.ghost, hand);
  EXPECT_TRUE(motion.planes.empty());
}

TEST(VoxelWorld, StartsTheGhostAtTheNearestFreePlaceOfAHandInMatterOrOutside) {
  VoxelWorld sut = box();
  for (const Position3 hand : {Position3{0.04, 0.001, 0.002}, Position3{7, 0.001, 0.002},
                               Position3{1e300, 0.001, 0.002}}) {
    const ProbeId probe = sut.add_probe(hand).value();
    const ProbeMotion motion = sut.move_probe(probe, hand, kTick);
    EXPECT_EQ(motion.ghost, (Position3{0.015, 0.001, 0.002}));
    EXPECT_EQ(motion.planes.size(), 1U);
    EXPECT_FALSE(motion.is_embedded);
    sut.remove_probe(probe);
  }
}

// The thesis's text has a spring to the ghost, its program one to each plane.
TEST(VoxelWorld, InABoxThePlanesLieWhereASpringToTheGhostWouldPull) {
  VoxelWorld sut = box();
  const ProbeId probe = sut.add_probe({}).value();
  std::mt19937 random(8);
  std::uniform_real_distribution<double> anywhere(-0.04, 0.04);
  std::size_t most = 0;
  for (int i = 0; i < 2000; ++i) {
    const Position3 hand{anywhere(random), anywhere(random), anywhere(random)};
    const ProbeMotion motion = sut.move_probe(probe, hand, kTick);
    Displacement3 out;
    for (const ContactPlane& plane : motion.planes) {
      const double depth_m = dot(plane.normal, hand) - plane.offset_m;
      for (std::size_t axis = 0; axis < 3; ++axis) out[axis] -= depth_m * plane.normal[axis];
    }
    EXPECT_LT(norm(out - (motion.ghost - hand)), 1e-15);
    most = std::max(most, motion.planes.size());
  }
  EXPECT_EQ(most, 3U);
}

TEST(VoxelWorld, FindsTheOneFreeCellHoweverFar) {
  VoxelGrid grid = empty_grid({70, 30, 20}, 0.001);
  grid.fill();
  grid.set_occupied({66, 3, 17}, false);
  VoxelWorld sut(grid, "one hole");
  const Position3 hand{-0.03, 0.01, -0.005};
  const ProbeId probe = sut.add_probe(hand).value();
  const ProbeMotion motion = sut.move_probe(probe, hand, kTick);
  EXPECT_EQ(motion.ghost, (Position3{grid.face_m(0, 66), grid.face_m(1, 4), grid.face_m(2, 17)}));
}

TEST(VoxelWorld, AWorldWithoutAFreeCellTakesNoProbe) {
  VoxelGrid grid = empty_grid({20, 20, 20}, 0.001);
  grid.fill();
  VoxelWorld sut(grid, "block");
  EXPECT_EQ(sut.add_probe({}).error().code, Errc::NotFound);
}

// A search of all of it for each of these would outlast the time that a test has.
TEST(VoxelWorld, AFullWorldRefusesAtOnceHoweverLargeAndTakesProbesAgain) {
  VoxelGrid grid = empty_grid({256, 256, 256}, 0.001);
  grid.fill();
  VoxelWorld sut(grid, "block");
  for (int i = 0; i < 1000000; ++i) {
    ASSERT_EQ(sut.add_probe({0.001 * (i % 256), 0, 0}).error().code, Errc::NotFound);
  }
  sut.set_row({3, 4, 5}, 4, 0);
  const auto probe = sut.add_probe({});
  ASSERT_TRUE(probe);
  sut.remove_probe(*probe);
  sut.set_cell({3, 4, 5}, true);
  EXPECT_EQ(sut.add_probe({}).error().code, Errc::NotFound);
}

TEST(VoxelWorld, HasRoomForEightProbesAndReusesIt) {
  VoxelWorld sut = box();
  std::vector<ProbeId> probes;
  for (std::size_t i = 0; i < kMaxProbes; ++i) {
    probes.push_back(sut.add_probe({}).value());
  }
  EXPECT_EQ(sut.add_probe({}).error().code, Errc::Busy);
  sut.remove_probe(probes[3]);
  const ProbeId again = sut.add_probe({}).value();
  for (const ProbeId probe : probes) EXPECT_NE(probe, again);
}

TEST(VoxelWorld, MovesEachProbeByItself) {
  VoxelWorld sut = box();
  const ProbeId left = sut.add_probe({}).value();
  const ProbeId right = sut.add_probe({}).value();
  EXPECT_EQ(sut.move_probe(left, {-0.02, 0, 0}, kTick).ghost.x, -0.015);
  EXPECT_EQ(sut.move_probe(right, {0.02, 0, 0}, kTick).ghost.x, 0.015);
  EXPECT_EQ(sut.move_probe(left, {-0.01, 0, 0}, kTick).ghost.x, -0.01);
}

TEST(VoxelWorld, AnUnknownProbeIsAtTheHandAndFeelsNothing) {
  VoxelWorld sut = box();
  const ProbeId probe = sut.add_probe({}).value();
  sut.remove_probe(probe);
  const Position3 hand{0.04, 0, 0};
  const ProbeMotion motion = sut.move_probe(probe, hand, kTick);
  EXPECT_EQ(motion.ghost, hand);
  EXPECT_TRUE(motion.planes.empty());
}

TEST(VoxelWorld, RefusesAProbeWhoseHandIsNotFinite) {
  VoxelWorld sut = box();
  EXPECT_EQ(sut.add_probe({std::nan(""), 0, 0}).error().code, Errc::InvalidArgument);
}

TEST(VoxelWorld, ACellThatIsClearedOpensTheWay) {
  VoxelWorld sut = box();
  const ProbeId probe = sut.add_probe({}).value();
  const Position3 hand{0.02, 0, 0};
  EXPECT_EQ(sut.move_probe(probe, hand, kTick).planes.size(), 1U);
  sut.set_cell({2, 1, 1}, false);
  EXPECT_FALSE(sut.is_occupied({2, 1, 1}));
  EXPECT_TRUE(sut.move_probe(probe, hand, kTick).planes.empty());
}

// Cell by cell is what it means; places to start at are found by what is remembered of rows.
TEST(VoxelWorld, AllCellsAtOnceAreAsCellByCell) {
  std::mt19937 random(23);
  for (const std::array<std::uint32_t, 3> cells :
       {std::array<std::uint32_t, 3>{64, 4, 2}, {5, 7, 3}, {128, 8, 1}, {16, 16, 16}}) {
    VoxelWorld sut(empty_grid(cells, 0.001), "at once");
    VoxelWorld slow(empty_grid(cells, 0.001), "cell by cell");
    for (int round = 0; round < 20; ++round) {
      VoxelGrid wanted = empty_grid(cells, 0.001);
      Cell at;
      for (at.z = 0; at.z < static_cast<std::int32_t>(cells[2]); ++at.z) {
        for (at.y = 0; at.y < static_cast<std::int32_t>(cells[1]); ++at.y) {
          const bool is_full = random() % 2 == 0;
          for (at.x = 0; at.x < static_cast<std::int32_t>(cells[0]); ++at.x) {
            const bool is_occupied = is_full || random() % 4 == 0;
            wanted.set_occupied(at, is_occupied);
            slow.set_cell(at, is_occupied);
          }
        }
      }
      sut.assign(wanted.words());
      ASSERT_EQ(*sut.grid(), *slow.grid());
      ASSERT_EQ(sut.occupied_cells(), slow.occupied_cells());
      const auto place = sut.add_probe({});
      const auto expected = slow.add_probe({});
      ASSERT_EQ(place.has_value(), expected.has_value());
      if (!place) continue;
      EXPECT_EQ(sut.move_probe(*place, {}, kTick).ghost,
                slow.move_probe(*expected, {}, kTick).ghost);
      sut.remove_probe(*place);
      slow.remove_probe(*expected);
    }
  }
}

}  // namespace
}  // namespace thimble::world
