#include "daemon/coupling/ghost_point_world.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "daemon/coupling/press_counter.hpp"
#include "daemon/world/voxel_world.hpp"
#include "fake_box.hpp"
#include "hand_samples.hpp"

namespace thimble::coupling {
namespace {

using testing::FakeBox;
using testing::kTick;
using testing::sample;

TEST(GhostPointWorld, AnswersTheSampleItWasAsked) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 7);
  ASSERT_TRUE(sut.open(sample(1, {})));
  (void)sut.answer(sample(1, {}), kTick);
  const ConstraintSet set = sut.answer(sample(5, {0.020, 0, -0.016}), kTick);
  EXPECT_EQ(set.sequence, 2U);
  EXPECT_EQ(set.answers, 5U);
  EXPECT_EQ(set.sampled_at, (MonotonicTime{kTick * 5}));
  EXPECT_EQ(set.session, 7U);
  ASSERT_EQ(set.planes.size(), 2U);
  EXPECT_EQ(set.planes[0].normal, (Direction3{1, 0, 0}));
  EXPECT_EQ(set.planes[0].offset_m, 0.015);
  EXPECT_EQ(set.planes[1].normal, (Direction3{0, 0, -1}));
  EXPECT_TRUE(set.has_ghost);
  EXPECT_EQ(set.ghost, (Position3{0.015, 0, -0.015}));
  EXPECT_FALSE(set.is_embedded);
}

TEST(GhostPointWorld, PassesOnSurfaceAndEmbedding) {
  FakeBox box(0.015);
  box.stiffness = {300};
  box.damping = {2};
  box.is_embedded = true;
  GhostPointWorld sut(box, 1);
  ASSERT_TRUE(sut.open(sample(1, {})));
  const ConstraintSet set = sut.answer(sample(1, {0.02, 0, 0}), kTick);
  EXPECT_EQ(set.planes[0].surface, (SurfaceProperties{{300}, {2}}));
  EXPECT_TRUE(set.is_embedded);
}

TEST(GhostPointWorld, PassesOnThePressureAndForgetsItWithTheFace) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 1);
  ASSERT_TRUE(sut.open(sample(1, {})));
  EXPECT_FALSE(sut.answer(sample(1, {0.02, 0, 0}), kTick).has_pressure) << "it knows of none";
  box.pressure = Force3{-0.5, 0, 0};
  const ConstraintSet set = sut.answer(sample(2, {0.02, 0, 0}), kTick);
  ASSERT_TRUE(set.has_pressure);
  EXPECT_EQ(set.pressure, (Force3{-0.5, 0, 0}));
  box.pressure.reset();
  EXPECT_FALSE(sut.answer(sample(3, {}), kTick).has_pressure);
}

TEST(GhostPointWorld, ForgetsPlanesThatNoLongerHold) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 1);
  ASSERT_TRUE(sut.open(sample(1, {})));
  (void)sut.answer(sample(1, {0.02, 0, 0}), kTick);
  EXPECT_TRUE(sut.answer(sample(2, {0.01, 0, 0}), kTick).planes.empty());
}

TEST(GhostPointWorld, AWorldThatCannotSayAnythingGivesTheLastAnswerAgain) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 1);
  ASSERT_TRUE(sut.open(sample(1, {})));
  const ConstraintSet good = sut.answer(sample(1, {0.02, 0, 0}), kTick);
  box.is_silent = true;
  const ConstraintSet silent = sut.answer(sample(2, {0.01, 0, 0}), kTick);
  EXPECT_EQ(silent.sequence, good.sequence);
  EXPECT_EQ(silent.answers, good.answers);
  EXPECT_EQ(silent.planes, good.planes);
  box.is_silent = false;
  EXPECT_EQ(sut.answer(sample(3, {0.01, 0, 0}), kTick).sequence, good.sequence + 1);
}

TEST(GhostPointWorld, ButtonsAreToldWhenTheyArePressedAndNotAgain) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 1);
  const auto with = [](std::uint64_t number, std::uint32_t buttons) {
    HandSample it = sample(number, {});
    it.buttons = buttons;
    return it;
  };
  ASSERT_TRUE(sut.open(with(1, 1)));
  for (const std::uint32_t buttons : {1U, 3U, 3U, 0U, 1U})
    (void)sut.answer(with(2, buttons), kTick);
  EXPECT_EQ(box.presses, (std::vector<std::uint32_t>{0, 2, 0, 0, 1})) << "held since before: none";
}

// A person presses, and of what the arm tells any sample may be lost: the world hears of each press
// once, in its time, a few in each answer.
TEST(GhostPointWorld, NoPressIsLostWithASample) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    FakeBox box(0.015);
    GhostPointWorld sut(box, 1);
    PressCounter counter;
    std::array<unsigned, 10> pressed{};
    std::uint32_t buttons = random() & 0x3FFU;
    HandSample told = sample(1, {});
    counter.count(buttons, told);
    ASSERT_TRUE(sut.open(told));
    for (std::uint64_t number = 2; number < 3000; ++number) {
      const std::uint32_t before = buttons;
      if (random() % 7 == 0 && number < 2000) buttons ^= 1U << (random() % 10);
      for (std::size_t i = 0; i < 8; ++i) pressed[i] += (buttons & ~before) >> i & 1U;
      told = sample(number, {});
      told.buttons = buttons;
      counter.count(buttons, told);
      if (random() % 100 >= seed * 4) (void)sut.answer(told, kTick);
      if (number % 500 == 0) (void)sut.answer(told, kTick);
    }
    std::array<unsigned, 10> heard{};
    for (const std::uint32_t press : box.presses) {
      for (std::size_t i = 0; i < 10; ++i) heard[i] += press >> i & 1U;
    }
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(heard[i], pressed[i]) << seed << ", " << i;
  }
}

TEST(GhostPointWorld, HearsNoMorePressesInOneAnswerThanAHandCouldMake) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 1);
  ASSERT_TRUE(sut.open(sample(1, {})));
  HandSample hostile = sample(2, {});
  hostile.has_presses = true;
  hostile.presses.fill(255);
  (void)sut.answer(hostile, kTick);
  EXPECT_EQ(box.presses, (std::vector<std::uint32_t>(ProbeInWorld::kMostPresses, 0xFF)));
}

TEST(GhostPointWorld, SampleThatIsNotFiniteGetsTheLastAnswerAgain) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 1);
  ASSERT_TRUE(sut.open(sample(1, {})));
  const ConstraintSet good = sut.answer(sample(1, {0.02, 0, 0}), kTick);
  const ConstraintSet again = sut.answer(sample(2, {std::nan(""), 0, 0}), kTick);
  EXPECT_EQ(box.moves, 1);
  EXPECT_EQ(again.sequence, good.sequence);
  EXPECT_EQ(again.answers, good.answers);
  EXPECT_EQ(again.planes, good.planes);
}

TEST(GhostPointWorld, EachOpenIsANewSessionWithOneProbe) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 41);
  ASSERT_TRUE(sut.open(sample(1, {})));
  EXPECT_EQ(sut.answer(sample(1, {0.02, 0, 0}), kTick).session, 41U);
  ASSERT_TRUE(sut.open(sample(1, {})));
  const ConstraintSet set = sut.answer(sample(1, {}), kTick);
  EXPECT_EQ(set.session, 42U);
  EXPECT_EQ(set.sequence, 1U);
  EXPECT_EQ(box.probes, 1);
}

TEST(GhostPointWorld, LeavesTheWorldWhenClosedOrDestroyed) {
  FakeBox box(0.015);
  {
    GhostPointWorld sut(box, 1);
    ASSERT_TRUE(sut.open(sample(1, {})));
    sut.close();
    sut.close();
    EXPECT_EQ(box.probes, 0);
    ASSERT_TRUE(sut.open(sample(1, {})));
  }
  EXPECT_EQ(box.probes, 0);
}

TEST(GhostPointWorld, OpenPassesOnWhyTheWorldRefuses) {
  FakeBox box(0.015);
  box.is_full = true;
  GhostPointWorld sut(box, 1);
  const Result<void> opened = sut.open(sample(1, {}));
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Errc::Busy);
  EXPECT_TRUE(sut.answer(sample(1, {0.02, 0, 0}), kTick).planes.empty());
}

TEST(GhostPointWorld, RefusesToOpenAtAPlaceThatIsNotFinite) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 1);
  const Result<void> opened = sut.open(sample(1, {0, std::nan(""), 0}));
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Errc::InvalidArgument);
  EXPECT_EQ(box.probes, 0);
}

TEST(GhostPointWorld, GivesTheWorldAPositiveTimeStep) {
  FakeBox box(0.015);
  GhostPointWorld sut(box, 1);
  ASSERT_TRUE(sut.open(sample(1, {})));
  (void)sut.answer(sample(1, {}), Duration(-5));
  EXPECT_GT(box.last_dt, Duration::zero());
}

TEST(GhostPointWorld, NamesTheCellOfTheGhostWhereTheWorldHasCells) {
  FakeBox box(0.015);
  GhostPointWorld without(box, 1);
  ASSERT_TRUE(without.open(sample(1, {})));
  EXPECT_FALSE(without.answer(sample(2, {}), kTick).has_ghost_cell);
  world::VoxelWorld cells(world::make_box(9).value(), "box:9");
  GhostPointWorld sut(cells, 1);
  ASSERT_TRUE(sut.open(sample(1, {})));
  const ConstraintSet set = sut.answer(sample(2, {1, 0, 0}), kTick);
  EXPECT_TRUE(set.has_ghost_cell);
  const world::Cell cell = set.ghost_cell;
  EXPECT_FALSE(cells.grid()->is_occupied(cell));
  EXPECT_TRUE(cells.grid()->is_occupied({cell.x + 1, cell.y, cell.z}));
  EXPECT_EQ(set.ghost.x, cells.grid()->face_m(0, cell.x + 1)) << "on the face between the two";
}

}  // namespace
}  // namespace thimble::coupling
