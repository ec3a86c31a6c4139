#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/unit/world/cam/hand_in_world.hpp"

// The faces of a buffer zone, as a world of pieces tells them.
namespace thimble::world::cam {
namespace {

using std::chrono::milliseconds;
using test::at;
using test::kCell_m;
using test::kSpace;
using test::one_square;
using test::two_squares;

class PieceZoneFaces : public test::HandInWorld {
 protected:
  void SetUp() override {
    begin({.pieces = {.space = kSpace, .search = SearchKind::BoundedSweep},
           .source = "pieces",
           .pressure = Stiffness{10}},
          two_squares());
  }
  // Of the face that looks this way, as many cells from the middle; NaN: it is not told.
  [[nodiscard]] double cells_to(const Direction3& normal) const {
    for (const ContactPlane& face : world_->zone_faces()) {
      if (face.normal == normal) return face.offset_m / kCell_m;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
  // Long enough for the first look, which loads a table.
  ProbeMotion rest(Position3 hand) { return hold(hand, milliseconds(60)); }
  [[nodiscard]] std::uint64_t looks() const { return world_->board().counters().zones; }

  static constexpr Direction3 kLeft{-1, 0, 0};
  static constexpr Direction3 kRight{1, 0, 0};
  static constexpr Direction3 kDown{0, -1, 0};
};

TEST_F(PieceZoneFaces, AreToldBeforeTheHandIsThereAsFarAsTheZoneGoes) {
  world_->mark_zone(4);
  rest(at(16, 18));
  EXPECT_EQ(cells_to(kRight), 4) << "the fourth cell on is the square's first";
  EXPECT_EQ(world_->zone_faces().size(), 1U);
  rest(at(15, 18));
  EXPECT_EQ(cells_to(kLeft), 4) << "the other square's";
  EXPECT_EQ(world_->zone_faces().size(), 1U);
  rest(at(16, 3));
  EXPECT_EQ(cells_to(kDown), 16) << "the edge of the space";
  EXPECT_EQ(world_->zone_faces()[0].stiffness.newton_per_m, -1) << "it is as the arm has it";
  EXPECT_EQ(world_->zone_faces().size(), 1U);
}

TEST_F(PieceZoneFaces, AreNotLookedForBeforeAnArmWantsThemNorAfterItIsGone) {
  rest(at(16, 18));
  EXPECT_EQ(looks(), 0U);
  EXPECT_TRUE(world_->zone_faces().empty());
  world_->mark_zone(4);
  rest(at(16, 18));
  rest(at(16, 18));
  EXPECT_EQ(looks(), 1U) << "once a cell";
  rest(at(17, 18));
  EXPECT_EQ(looks(), 2U);
  world_->remove_probe(probe_);
  probe_ = world_->add_probe(at(16, 16)).value();
  rest(at(15, 18));
  EXPECT_EQ(looks(), 2U);
  EXPECT_TRUE(world_->zone_faces().empty());
}

TEST_F(PieceZoneFaces, AreThoseThatTheHeldPieceMeetsAndAsStiffAsCellsWillPress) {
  world_->mark_zone(12);
  rest(at(16, 15));
  rest(at(10, 15));
  EXPECT_EQ(cells_to(kLeft), 4);
  EXPECT_EQ(world_->zone_faces()[0].stiffness.newton_per_m, 10) << "of one cell, the finger's";
  ASSERT_EQ(act(PieceAction::Select, at(10, 15)), PieceOutcome::Selected);
  const ProbeMotion motion = rest(at(11, 15));
  ASSERT_FALSE(motion.is_embedded);
  // The square ends at the grasp point, 8 cells from the other, and 4 of its rows meet that.
  EXPECT_EQ(cells_to(kRight), 4);
  EXPECT_EQ(world_->zone_faces()[0].stiffness.newton_per_m, 40);
}

TEST_F(PieceZoneFaces, OfPiecesAreNotToldInFreeMotion) {
  world_->mark_zone(6);
  rest(at(16, 18));
  EXPECT_EQ(cells_to(kRight), 4);
  ASSERT_EQ(act(PieceAction::ToggleFree, at(16, 18)), PieceOutcome::FreeMotionOn);
  EXPECT_TRUE(world_->zone_faces().empty());
  rest(at(16, 3));
  EXPECT_EQ(cells_to(kDown), 16) << "but the edges are";
  rest(at(16, 18));
  ASSERT_EQ(act(PieceAction::ToggleFree, at(16, 18)), PieceOutcome::FreeMotionOff);
  rest(at(16, 18));
  EXPECT_EQ(cells_to(kRight), 4);
}

// The board takes longer than a millisecond to look around.
TEST_F(PieceZoneFaces, NeverLieBehindTheGhost) {
  world_->mark_zone(12);
  rest(at(16, 14));
  std::mt19937 random(2);
  int faces = 0;
  for (int i = 0; i < 300; ++i) {
    const Position3 hand =
        at(8 + static_cast<int>(random() % 16), 8 + static_cast<int>(random() % 19));
    for (int k = 0; k < 4; ++k) {
      const ProbeMotion motion = hold(hand, milliseconds(1));
      for (const ContactPlane& face : world_->zone_faces()) {
        ASSERT_LE(dot(face.normal, motion.ghost), face.offset_m + 1e-12) << i;
        ++faces;
      }
    }
  }
  EXPECT_GT(faces, 500);
}

TEST_F(PieceZoneFaces, AreFoundByTheTrailInItsBoxAlone) {
  EXPECT_TRUE(world_->finds_zone_faces());
  for (const auto search : {SearchKind::OneCell, SearchKind::Leap, SearchKind::Sweep}) {
    begin({.pieces = {.space = kSpace, .search = search}, .source = "pieces"}, one_square());
    EXPECT_FALSE(world_->finds_zone_faces());
  }
}

TEST_F(PieceZoneFaces, AreForgottenWithTheBoardAndFoundAnew) {
  world_->mark_zone(4);
  rest(at(16, 18));
  ASSERT_EQ(cells_to(kRight), 4);
  slot_->unplug();
  hold(at(16, 18), milliseconds(200));
  EXPECT_TRUE(world_->zone_faces().empty());
  plug_in();
  hold(at(16, 18), milliseconds(400));
  EXPECT_EQ(cells_to(kRight), 4);
}

}  // namespace
}  // namespace thimble::world::cam
