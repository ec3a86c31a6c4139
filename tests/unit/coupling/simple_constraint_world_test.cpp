#include "daemon/coupling/simple_constraint_world.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/coupling/constraint_model.hpp"
#include "daemon/coupling/ghost_point_world.hpp"
#include "daemon/world/voxel_world.hpp"
#include "fake_box.hpp"
#include "hand_samples.hpp"

namespace thimble::coupling {
namespace {

using testing::kTick;
using testing::sample;

class SimpleConstraintWorldTest : public ::testing::Test {
 protected:
  world::VoxelGrid box = world::make_box(3).value();
  SimpleConstraintWorld sut{box, 7};
};

TEST_F(SimpleConstraintWorldTest, AnswersTheSampleItWasAskedWithoutAGhost) {
  ASSERT_TRUE(sut.open(sample(1, {})));
  (void)sut.answer(sample(1, {}), kTick);
  const ConstraintSet set = sut.answer(sample(5, {0.020, 0, -0.016}), kTick);
  EXPECT_EQ(set.sequence, 2U);
  EXPECT_EQ(set.answers, 5U);
  EXPECT_EQ(set.sampled_at, (MonotonicTime{kTick * 5}));
  EXPECT_EQ(set.session, 7U);
  ASSERT_EQ(set.planes.size(), 1U) << "from the filled cell at +x into another: not new";
  EXPECT_EQ(set.planes[0].normal, (Direction3{1, 0, 0}));
  EXPECT_DOUBLE_EQ(set.planes[0].offset_m, 0.015);
  EXPECT_FALSE(set.has_ghost);
}

TEST_F(SimpleConstraintWorldTest, EachOpenIsANewSessionThatRemembersNothing) {
  ASSERT_TRUE(sut.open(sample(1, {})));
  EXPECT_EQ(sut.answer(sample(1, {0.02, 0, 0}), kTick).planes.size(), 1U);
  ASSERT_TRUE(sut.open(sample(1, {0.02, 0, 0})));
  const ConstraintSet set = sut.answer(sample(1, {0.02, 0, 0}), kTick);
  EXPECT_EQ(set.session, 8U);
  EXPECT_EQ(set.sequence, 1U);
  EXPECT_TRUE(set.planes.empty());
  EXPECT_TRUE(set.is_embedded);
}

TEST_F(SimpleConstraintWorldTest, ASampleThatIsNotFiniteGetsTheLastAnswerAgain) {
  EXPECT_FALSE(sut.open(sample(1, {0, std::nan(""), 0})));
  ASSERT_TRUE(sut.open(sample(1, {})));
  const ConstraintSet good = sut.answer(sample(1, {0.02, 0, 0}), kTick);
  const ConstraintSet again = sut.answer(sample(2, {std::nan(""), 0, 0}), kTick);
  EXPECT_EQ(again.sequence, good.sequence);
  EXPECT_EQ(again.planes, good.planes);
}

TEST_F(SimpleConstraintWorldTest, ClosedItAnswersNothingNew) {
  ASSERT_TRUE(sut.open(sample(1, {})));
  sut.close();
  EXPECT_EQ(sut.answer(sample(1, {0.02, 0, 0}), kTick).sequence, 0U);
}

TEST(ConstraintModel, MakesTheWorldHalfItNames) {
  world::VoxelWorld cells(world::make_box(3).value(), "box:3");
  const auto ghost = make_world_coupling(ConstraintModel::GhostPoint, cells, 1);
  const auto simple = make_world_coupling(ConstraintModel::Simple, cells, 1);
  ASSERT_TRUE(ghost && simple);
  EXPECT_NE(dynamic_cast<GhostPointWorld*>(ghost->get()), nullptr);
  EXPECT_NE(dynamic_cast<SimpleConstraintWorld*>(simple->get()), nullptr);
}

TEST(ConstraintModel, SimpleIsRefusedInAWorldWithoutCellsAndTheReasonIsSaid) {
  testing::FakeBox box(0.015);
  EXPECT_TRUE(make_world_coupling(ConstraintModel::GhostPoint, box, 1));
  const auto refused = make_world_coupling(ConstraintModel::Simple, box, 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::Unsupported);
  EXPECT_NE(refused.error().message.find("works on cells"), std::string::npos);
}

}  // namespace
}  // namespace thimble::coupling
