#include <gtest/gtest.h>

#include "tests/unit/world/cam/hand_in_world.hpp"

// What a hand in a world of pieces feels of a board that hangs, is away, and comes back.
namespace thimble::world::cam {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::at;

class PieceSilence : public test::HandInWorld {
 protected:
  void SetUp() override {
    HandInWorld::SetUp();
    hold(at(16, 16));
    ASSERT_EQ(hold(at(9, 15)).planes.size(), 1U) << "the piece's right face";
  }
};

TEST_F(PieceSilence, AMachineThatHangsWhileItsPageBeatsIsNotBelievedForLong) {
  hang(seconds(60));
  EXPECT_FALSE(hold(at(9, 15), PieceWorld::kOverdue).is_silent);
  EXPECT_TRUE(hold(at(9, 15), PieceWorld::kLookEvery + milliseconds(10)).is_silent);
  EXPECT_FALSE(world_->board().trouble()) << "its patience is longer";
}

TEST_F(PieceSilence, AnActionThatHangsIsNotBelievedForLongEither) {
  hang(seconds(60));
  ASSERT_TRUE(world_->submit(PieceAction::ToggleFree));
  EXPECT_TRUE(hold(at(9, 15), PieceWorld::kOverdue + milliseconds(10)).is_silent);
}

TEST_F(PieceSilence, AMachineThatGoesOnBeforeThePatienceIsOverIsFeltAgain) {
  hang(milliseconds(600));
  EXPECT_TRUE(hold(at(9, 15), milliseconds(500)).is_silent);
  const ProbeMotion motion = hold(at(9, 15), milliseconds(200));
  EXPECT_FALSE(motion.is_silent);
  EXPECT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(world_->board().counters().failures, 0U);
}

}  // namespace
}  // namespace thimble::world::cam
