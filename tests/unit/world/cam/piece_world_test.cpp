#include "daemon/world/cam/piece_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/world/cam/hand_in_world.hpp"

namespace thimble::world::cam {
namespace {

using std::chrono::milliseconds;
using test::at;
using test::kCell_m;
using test::kSpace;
using test::one_square;
using test::two_squares;

using PieceWorldTest = test::HandInWorld;

TEST_F(PieceWorldTest, IsSilentUntilTheBoardHasAnswered) {
  EXPECT_TRUE(world_->move_probe(probe_, at(16, 16), milliseconds(1)).is_silent);
  const ProbeMotion motion = hold(at(16, 16));
  EXPECT_FALSE(motion.is_silent);
  EXPECT_TRUE(motion.planes.empty());
  EXPECT_EQ(motion.ghost, at(16, 16));
}

TEST_F(PieceWorldTest, APieceStopsTheHandAtItsFaceAndNothingDoesAlongAnAxisOfOneCell) {
  hold(at(16, 16));
  const ProbeMotion motion = hold(at(9, 15, 0.03));
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0].normal, (Direction3{-1, 0, 0}));
  EXPECT_NEAR(motion.planes[0].offset_m, 4 * kCell_m, 1e-12) << "x of its right face, 12 - 16";
  EXPECT_NEAR(motion.ghost.x, -4 * kCell_m, 1e-12);
  EXPECT_EQ(motion.ghost.y, at(9, 15).y) << "it slides along";
  EXPECT_EQ(motion.ghost.z, 0.03);
  EXPECT_FALSE(motion.is_embedded);
}

TEST_F(PieceWorldTest, TheWorldHasWalls) {
  hold(at(16, 16));
  const ProbeMotion motion = hold(at(33, -2));
  ASSERT_EQ(motion.planes.size(), 2U);
  EXPECT_EQ(motion.planes[0].normal, (Direction3{1, 0, 0}));
  EXPECT_NEAR(motion.planes[0].offset_m, 0.045, 1e-12);
  EXPECT_EQ(motion.planes[1].normal, (Direction3{0, -1, 0}));
  EXPECT_NEAR(motion.planes[1].offset_m, 0.045, 1e-12);
  EXPECT_TRUE(hold(at(30, 1)).planes.empty());
}

TEST_F(PieceWorldTest, FacesAreAsTheArmHasThemUnlessPressureIsAskedFor) {
  hold(at(16, 16));
  ASSERT_EQ(hold(at(9, 15)).planes.size(), 1U);
  EXPECT_EQ(hold(at(9, 15)).planes[0].stiffness.newton_per_m, -1);
}

TEST_F(PieceWorldTest, WithPressureAFaceIsAsStiffAsThereAreCellsThatPressOnIt) {
  for (const auto search :
       {SearchKind::OneCell, SearchKind::Leap, SearchKind::Sweep, SearchKind::BoundedSweep}) {
    begin({.pieces = {.space = kSpace, .search = search}, .pressure = Stiffness{10}},
          two_squares());
    hold(at(16, 16));
    const ProbeMotion finger = hold(at(9, 15));
    ASSERT_EQ(finger.planes.size(), 1U);
    EXPECT_EQ(finger.planes[0].stiffness.newton_per_m, 10) << "it is one cell";
    ASSERT_EQ(act(PieceAction::Select, at(9, 15)), PieceOutcome::Selected);
    // Both are 8 cells high, the other one 4 cells farther up.
    for (int up = -6; up <= 4; ++up) {
      hold(at(9, 15 + up), milliseconds(60));
      const ProbeMotion motion = hold(at(22, 15 + up), milliseconds(60));
      const int cells = std::max(0, 4 + up);
      ASSERT_EQ(motion.planes.size(), cells > 0 ? 1U : 0U) << up;
      if (cells > 0) {
        EXPECT_EQ(motion.planes[0].stiffness.newton_per_m, 10 * cells) << up;
      }
    }
  }
}

TEST_F(PieceWorldTest, ThereIsNoPressureOnTheWorldsWallsNorInFreeMotion) {
  begin({.pieces = {.space = kSpace}, .pressure = Stiffness{10}}, two_squares());
  hold(at(16, 16));
  const ProbeMotion edge = hold(at(16, 33));
  ASSERT_EQ(edge.planes.size(), 1U);
  EXPECT_EQ(edge.planes[0].stiffness.newton_per_m, -1);
  hold(at(16, 16));
  ASSERT_EQ(hold(at(9, 15)).planes.size(), 1U);
  ASSERT_EQ(act(PieceAction::ToggleFree, at(9, 15)), PieceOutcome::FreeMotionOn);
  EXPECT_TRUE(hold(at(9, 15)).planes.empty());
}

TEST_F(PieceWorldTest, ParticlesDriftFiftyTimesASecondHandOrNot) {
  hold(at(16, 16), milliseconds(200));
  EXPECT_EQ(world_->board().counters().drifts, 0U) << "static pieces have none";
  begin({.space = kSpace, .is_dynamic = true});
  hold(at(16, 16), milliseconds(200));
  const std::uint64_t with_hand = world_->board().counters().drifts;
  EXPECT_GE(with_hand, 8U);
  EXPECT_LE(with_hand, 11U);
  world_->remove_probe(probe_);
  for (int i = 0; i < 200; ++i) {
    clock_.run_for(milliseconds(1));
    world_->pump();
  }
  const std::uint64_t without = world_->board().counters().drifts - with_hand;
  EXPECT_GE(without, 8U);
  EXPECT_LE(without, 11U);
}

TEST_F(PieceWorldTest, PiecesAmongParticlesAreFeltAndMovedAsEver) {
  begin({.space = kSpace, .is_dynamic = true});
  hold(at(16, 16));
  EXPECT_EQ(hold(at(9, 15)).planes.size(), 1U);
  EXPECT_EQ(act(PieceAction::Select, at(9, 15)), PieceOutcome::Selected);
  const ProbeMotion motion = hold(at(20, 15), milliseconds(100));
  EXPECT_TRUE(motion.planes.empty()) << "particles stop nobody";
  EXPECT_EQ(motion.ghost.x, at(20, 15).x);
  EXPECT_EQ(act(PieceAction::Drop, at(20, 15)), PieceOutcome::Dropped);
  EXPECT_GT(world_->board().counters().drifts, 5U);
}

TEST_F(PieceWorldTest, AWallIsLearnedOfLate) {
  hold(at(16, 16));
  clock_.run_for(milliseconds(1));
  const ProbeMotion motion = world_->move_probe(probe_, at(9, 15), milliseconds(1));
  EXPECT_TRUE(motion.planes.empty()) << "the board has only begun to look";
  EXPECT_EQ(hold(at(9, 15)).planes.size(), 1U);
}

TEST_F(PieceWorldTest, AButtonSelectsWhatIsPressedAndDropsIt) {
  hold(at(16, 16));
  hold(at(9, 15));
  world_->press(probe_, 1);
  hold(at(9, 15), milliseconds(50));
  EXPECT_EQ(world_->take_finished().at(0).outcome, PieceOutcome::Selected);
  EXPECT_EQ(world_->board().state().held, 7);
  EXPECT_TRUE(hold(at(20, 20), milliseconds(50)).planes.empty()) << "nothing holds it back";
  world_->press(probe_, 1);
  hold(at(20, 20), milliseconds(50));
  EXPECT_EQ(world_->take_finished().at(0).outcome, PieceOutcome::Dropped);
  EXPECT_EQ(world_->board().state().held, 0);
  world_->press(probe_, 2);
  world_->press({99}, 1);
  hold(at(20, 20), milliseconds(50));
  const auto finished = world_->take_finished();
  ASSERT_EQ(finished.size(), 1U) << "nobody else has a button";
  EXPECT_EQ(finished[0].outcome, PieceOutcome::NothingHeld);
}

TEST_F(PieceWorldTest, TheHandThatIsThereAsksForFreeMotionAndAReset) {
  hold(at(16, 16));
  EXPECT_TRUE(world_->has_actions());
  EXPECT_TRUE(world_->act(probe_, HandAction::ToggleFree));
  EXPECT_FALSE(world_->act({99}, HandAction::ToggleFree)) << "nobody else";
  hold(at(16, 16), milliseconds(50));
  EXPECT_TRUE(world_->board().state().is_free_motion);
  EXPECT_EQ(world_->take_finished().size(), 1U);
  EXPECT_TRUE(world_->act(probe_, HandAction::Reset));
  hold(at(16, 16), milliseconds(50));
  const auto finished = world_->take_finished();
  ASSERT_EQ(finished.size(), 1U);
  EXPECT_EQ(finished[0].outcome, PieceOutcome::WasReset);
}

TEST_F(PieceWorldTest, TakesNoMoreOfAHandThanMayWait) {
  hold(at(16, 16));
  for (std::size_t i = 0; i < PieceWorld::kMaxWaiting; ++i) {
    ASSERT_TRUE(world_->act(probe_, HandAction::ToggleFree));
  }
  EXPECT_FALSE(world_->act(probe_, HandAction::ToggleFree));
}

// The space is a torus to the board, and has walls to the hand.
TEST_F(PieceWorldTest, AHandAtTheWorldsWallSelectsNothingThroughIt) {
  PieceLayout layout(kSpace.cells());
  for (int y = 24; y < 32; ++y) layout[index_of(kSpace, {0, y, 0})] = 5;
  begin({.pieces = {.space = kSpace}}, layout);
  hold(at(16, 31));
  ASSERT_EQ(hold(at(33, 31)).planes.size(), 1U);
  EXPECT_EQ(act(PieceAction::Select, at(33, 31)), PieceOutcome::NothingThere);
  EXPECT_EQ(world_->board().state().held, 0);
  EXPECT_EQ(world_->board().state().grasp, (CamAxes{31, 31, 0}));
}

TEST_F(PieceWorldTest, ActionsAreDoneWithoutAHandAndInTheirOrder) {
  world_->remove_probe(probe_);
  const PieceAction actions[] = {PieceAction::Drop, PieceAction::ToggleFree, PieceAction::Reset};
  for (const PieceAction action : actions) ASSERT_TRUE(world_->submit(action));
  for (int i = 0; i < 100; ++i) {
    clock_.run_for(milliseconds(1));
    world_->pump();
  }
  const auto finished = world_->take_finished();
  ASSERT_EQ(finished.size(), 3U);
  EXPECT_EQ(finished[0].outcome, PieceOutcome::NothingHeld);
  EXPECT_EQ(finished[1].outcome, PieceOutcome::FreeMotionOn);
  EXPECT_EQ(finished[2].outcome, PieceOutcome::WasReset);
  EXPECT_TRUE(world_->take_finished().empty());
}

// Two of them, each of whom asks anew when it has its answer.
TEST_F(PieceWorldTest, ClientsWhoLookAgainAndAgainLeaveTheHandAMoveBetweenTwoLooks) {
  hold(at(16, 16));
  const std::uint64_t moves = world_->board().counters().moves;
  std::uint64_t looks = 0;
  const auto ask = [&] { EXPECT_TRUE(world_->submit(PieceAction::Look)); };
  ask();
  ask();
  for (int ms = 0; ms < 1000; ++ms) {
    hold(at(16 + ms % 3, 20), milliseconds(1));
    for (const auto& answered : world_->take_finished()) {
      EXPECT_EQ(answered.outcome, PieceOutcome::Looked);
      ++looks;
      ask();
    }
  }
  EXPECT_GT(looks, 10U);
  EXPECT_GE(world_->board().counters().moves - moves + 1, looks);
}

TEST_F(PieceWorldTest, LooksAreDoneWhereNoHandMoves) {
  world_->remove_probe(probe_);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(world_->submit(PieceAction::Look));
  for (int i = 0; i < 500; ++i) {
    clock_.run_for(milliseconds(1));
    world_->pump();
  }
  EXPECT_EQ(world_->take_finished().size(), 3U);
}

TEST_F(PieceWorldTest, TooManyActionsAreRefused) {
  for (std::size_t i = 0; i < PieceWorld::kMaxWaiting; ++i) {
    ASSERT_TRUE(world_->submit(PieceAction::ToggleFree));
  }
  EXPECT_EQ(world_->submit(PieceAction::ToggleFree).error().code, Errc::Busy);
}

TEST_F(PieceWorldTest, OneHandAtATime) {
  EXPECT_EQ(world_->add_probe(at(1, 1)).error().code, Errc::Busy);
  world_->remove_probe(probe_);
  const auto next = world_->add_probe(at(20, 20));
  ASSERT_TRUE(next);
  EXPECT_NE(next->value, probe_.value);
  EXPECT_EQ(world_->move_probe(probe_, at(5, 5), milliseconds(1)).ghost, at(5, 5));
  probe_ = *next;
  EXPECT_TRUE(hold(at(20, 20)).planes.empty());
  EXPECT_EQ(world_->board().state().grasp, (CamAxes{20, 20, 0})) << "it starts at the hand";
}

TEST_F(PieceWorldTest, AHandThatAppearsWithinAPieceLeavesItFreely) {
  world_->remove_probe(probe_);
  probe_ = world_->add_probe(at(8, 15)).value();
  ProbeMotion motion = hold(at(8, 15));
  EXPECT_TRUE(motion.is_embedded);
  EXPECT_TRUE(motion.planes.empty());
  motion = hold(at(14, 15));
  EXPECT_FALSE(motion.is_embedded);
  EXPECT_EQ(hold(at(8, 15)).planes.size(), 1U) << "and does not come back that way";
}

TEST_F(PieceWorldTest, ABoardThatIsPulledOutMakesTheWorldSilentAndOneThatIsPluggedInIsFelt) {
  hold(at(16, 16));
  EXPECT_EQ(hold(at(9, 15)).planes.size(), 1U);
  slot_->unplug();
  EXPECT_TRUE(hold(at(9, 15), PieceWorld::kLookEvery + milliseconds(10)).is_silent);
  ASSERT_TRUE(world_->board().trouble());
  EXPECT_EQ(world_->board().trouble()->code, Errc::Disconnected);
  EXPECT_TRUE(hold(at(9, 15), milliseconds(300)).is_silent);
  plug_in();  // another one, whose memory is empty
  const ProbeMotion motion = hold(at(16, 16), milliseconds(300));
  EXPECT_FALSE(motion.is_silent);
  EXPECT_FALSE(world_->board().trouble());
  EXPECT_EQ(world_->board().counters().resets, 1U);
  EXPECT_EQ(hold(at(9, 15)).planes.size(), 1U) << "the piece is where it was at first";
}

TEST_F(PieceWorldTest, AnActionThatABoardFailedAtIsToldSo) {
  hold(at(16, 16));
  ASSERT_TRUE(world_->submit(PieceAction::ToggleFree));
  world_->pump();
  slot_->unplug();
  hold(at(16, 16), milliseconds(10));
  const auto finished = world_->take_finished();
  ASSERT_EQ(finished.size(), 1U);
  EXPECT_EQ(finished[0].outcome, PieceOutcome::BoardFailed);
}

TEST_F(PieceWorldTest, HandsThatAreNowhereAreNotFollowed) {
  EXPECT_EQ(world_->add_probe({NAN, 0, 0}).error().code, Errc::InvalidArgument);
  hold(at(16, 16));
  EXPECT_EQ(world_->move_probe(probe_, {NAN, 0, 0}, milliseconds(1)).ghost, at(16, 16));
  EXPECT_EQ(act(PieceAction::Drop, {1e300, -1e300, 0}), PieceOutcome::NothingHeld);
  EXPECT_EQ(world_->board().state().grasp, (CamAxes{31, 0, 0})) << "the corner";
}

TEST(PieceWorldSettings, ThatCannotBeAreRefused) {
  const sim::VirtualClock clock;
  const auto none = [](MonotonicTime) -> Result<std::unique_ptr<CamBoard>> {
    return fail(Errc::NotFound, "none");
  };
  EXPECT_FALSE(PieceWorld::create({.pieces = {.space = kSpace}, .workspace_m = 0}, none,
                                  one_square(), clock));
  EXPECT_FALSE(PieceWorld::create({.pieces = {.space = kSpace}}, none, {}, clock));
  for (const double pressure : {-1.0, std::nan("")}) {
    EXPECT_FALSE(PieceWorld::create({.pieces = {.space = kSpace}, .pressure = Stiffness{pressure}},
                                    none, one_square(), clock));
  }
}

}  // namespace
}  // namespace thimble::world::cam
