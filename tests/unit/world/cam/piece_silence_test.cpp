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
  // Away, until it is back with all that it held.
  void lose_board(Position3 hand) {
    hang(seconds(2));
    hold(hand, milliseconds(1200));
    ASSERT_TRUE(world_->board().trouble());
  }
  void find_board(Position3 hand) {
    hold(hand, seconds(2));
    ASSERT_FALSE(world_->board().trouble()) << world_->board().trouble()->message;
    ASSERT_EQ(world_->board().counters().resets, 0U);
  }
  // What it says once it says anything.
  ProbeMotion first_word(Position3 hand) {
    ProbeMotion motion{.is_silent = true};
    for (int ms = 0; ms < 3000 && motion.is_silent; ++ms) motion = hold(hand, milliseconds(1));
    EXPECT_FALSE(motion.is_silent);
    return motion;
  }
  std::vector<PieceOutcome> outcomes() {
    std::vector<PieceOutcome> outcomes;
    for (const auto& finished : world_->take_finished()) outcomes.push_back(finished.outcome);
    return outcomes;
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

TEST_F(PieceSilence, WhatIsPressedOrAskedWhileTheBoardIsAwayIsNotDoneWhenItComesBack) {
  ASSERT_EQ(act(PieceAction::Select, at(9, 15)), PieceOutcome::Selected);
  lose_board(at(9, 15));
  world_->press(probe_, 1);
  world_->press(probe_, 2);
  ASSERT_TRUE(world_->submit(PieceAction::Delete));
  EXPECT_EQ(outcomes(), std::vector(3, PieceOutcome::NoBoard)) << "at once";
  find_board(at(9, 15));
  EXPECT_EQ(world_->board().state().held, 7);
  EXPECT_EQ(world_->board().state().sizes[7], 64U);
  EXPECT_EQ(world_->board().counters().actions, 1U);
}

TEST_F(PieceSilence, WhatWaitsWhenTheBoardFailsIsNotDoneWhenItComesBack) {
  ASSERT_EQ(act(PieceAction::Select, at(9, 15)), PieceOutcome::Selected);
  ASSERT_TRUE(world_->submit(PieceAction::ToggleFree));
  world_->pump();
  for (int i = 0; i < 3; ++i) world_->press(probe_, 2);
  lose_board(at(9, 15));
  EXPECT_EQ(outcomes(), (std::vector{PieceOutcome::BoardFailed, PieceOutcome::NoBoard,
                                     PieceOutcome::NoBoard, PieceOutcome::NoBoard}))
      << "in the order in which they were asked for";
  find_board(at(9, 15));
  EXPECT_EQ(world_->board().state().held, 7);
  ASSERT_EQ(act(PieceAction::Delete, at(9, 15)), PieceOutcome::Deleted) << "now it is";
}

TEST_F(PieceSilence, TheFirstWordAfterAReturnIsOfWhereTheHandIsNow) {
  lose_board(at(9, 15));
  const ProbeMotion motion = first_word(at(25, 28));
  EXPECT_TRUE(motion.planes.empty()) << "it is far from the face that it pressed before";
  EXPECT_EQ(motion.ghost, at(25, 28));
  EXPECT_EQ(world_->board().counters().resets, 0U);
}

TEST_F(PieceSilence, AHandThatWentOnMeanwhileFeelsTheSameFaceAfterAReturn) {
  lose_board(at(9, 15));
  const ProbeMotion motion = first_word(at(6, 15));
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_NEAR(motion.planes[0].offset_m, 4 * test::kCell_m, 1e-12);
}

TEST_F(PieceSilence, ABoardThatLostItsMemoryHasNoWallInTheMiddleOfTheSpace) {
  hold(at(16, 16));
  ASSERT_EQ(hold(at(33, 16)).planes.size(), 1U) << "the world's wall";
  slot_->unplug();
  hold(at(40, 16), milliseconds(300));
  ASSERT_TRUE(world_->board().trouble());
  plug_in();
  const ProbeMotion motion = first_word(at(40, 16));
  ASSERT_EQ(world_->board().counters().resets, 1U);
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_NEAR(motion.planes[0].offset_m, 0.045, 1e-12);
}

TEST_F(PieceSilence, AResetIsNotFeltBeforeTheHandHasItsPlaceAgain) {
  hold(at(16, 16));
  ASSERT_EQ(hold(at(33, 16)).planes.size(), 1U);
  ASSERT_TRUE(world_->submit(PieceAction::Reset));
  for (int us = 0; us < 30000; us += 100) {
    clock_.run_for(std::chrono::microseconds(100));
    const ProbeMotion motion = world_->move_probe(probe_, at(33, 16), milliseconds(1));
    if (motion.is_silent) continue;
    ASSERT_EQ(motion.planes.size(), 1U);
    EXPECT_NEAR(motion.planes[0].offset_m, 0.045, 1e-12);
  }
  EXPECT_EQ(outcomes(), std::vector{PieceOutcome::WasReset});
}

TEST_F(PieceSilence, AnotherHandFeelsNothingOfTheOneBefore) {
  world_->move_probe(probe_, at(9, 16), milliseconds(1));  // a move is under way
  ASSERT_FALSE(world_->board().is_ready());
  world_->remove_probe(probe_);
  probe_ = world_->add_probe(at(25, 28)).value();
  const ProbeMotion motion = first_word(at(25, 28));
  EXPECT_TRUE(motion.planes.empty());
  EXPECT_EQ(motion.ghost, at(25, 28));
}

TEST_F(PieceSilence, WhatIsWithdrawnIsNotDone) {
  ASSERT_EQ(act(PieceAction::Select, at(9, 15)), PieceOutcome::Selected);
  hang(milliseconds(500));
  const auto begun = world_->submit(PieceAction::ToggleFree);
  hold(at(9, 15), milliseconds(2));
  const auto waiting = world_->submit(PieceAction::Delete);
  ASSERT_TRUE(begun && waiting);
  EXPECT_FALSE(world_->withdraw(*begun)) << "nobody knows what the board does";
  EXPECT_TRUE(world_->withdraw(*waiting));
  EXPECT_FALSE(world_->withdraw(*waiting));
  hold(at(9, 15), seconds(1));
  EXPECT_EQ(outcomes(), std::vector{PieceOutcome::FreeMotionOn});
  EXPECT_EQ(world_->board().state().held, 7);
}

}  // namespace
}  // namespace thimble::world::cam
