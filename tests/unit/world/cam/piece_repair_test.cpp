#include "daemon/world/cam/piece_repair.hpp"

#include <gtest/gtest.h>

// What is made of cells that a board is left with after a program that failed.
namespace thimble::world::cam {
namespace {

constexpr CamGeometry kSmall{{3, 3, 0}, CamDivision::Mesh};

// Piece 1 rests in the corner; piece 2 is held, and rests nowhere.
struct AfterAFailure : testing::Test {
  const PieceSettings settings{.space = kSmall};
  PieceState state;
  CamCells cells = CamCells(kSmall.cells());

  AfterAFailure() {
    cells[0] = cell::of_part(1);
    state.grasp = state.held_from = {4, 4, 0};
    state.held = 2;
    state.held_next = 0;
    state.sizes[1] = 1;
    state.sizes[2] = 1;
  }
};

TEST_F(AfterAFailure, APieceThatWasToBeDeletedAndIsGoneIsDeleted) {
  state.is_deleting = true;
  ASSERT_TRUE(repair(cells, state, settings));
  EXPECT_EQ(state.held, 0);
  EXPECT_EQ(state.sizes[2], 0U);
  EXPECT_FALSE(state.is_deleting);
}

TEST_F(AfterAFailure, APieceThatWasToBeDroppedAndIsGoneIsLost) {
  const PieceState before = state;
  const CamCells cells_before = cells;
  EXPECT_FALSE(repair(cells, state, settings));
  EXPECT_EQ(state, before) << "nothing is changed";
  EXPECT_EQ(cells, cells_before);
}

TEST_F(AfterAFailure, APieceThatWasDroppedIsThere) {
  cells[index_of(kSmall, {4, 4, 0})] |= cell::of_part(2);
  ASSERT_TRUE(repair(cells, state, settings));
  EXPECT_EQ(state.held, 0);
  EXPECT_EQ(state.sizes[2], 1U);
}

TEST_F(AfterAFailure, APieceThatWasToBeDeletedAndIsStillHeldIs) {
  state.is_deleting = true;
  cells[index_of(kSmall, {4, 4, 0})] |= cell::kOrigin;
  ASSERT_TRUE(repair(cells, state, settings));
  EXPECT_EQ(state.held, 2);
  EXPECT_EQ(state.sizes[2], 1U);
  EXPECT_FALSE(state.is_deleting) << "a drop that fails next deletes nothing";
}

TEST_F(AfterAFailure, AnotherPieceThatIsGoneIsLostWhateverWasDone) {
  state.is_deleting = true;
  cells[0] = 0;
  EXPECT_FALSE(repair(cells, state, settings));
}

}  // namespace
}  // namespace thimble::world::cam
