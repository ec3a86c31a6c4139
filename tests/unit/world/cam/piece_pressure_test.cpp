#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "tests/unit/world/cam/hand_in_world.hpp"

// With what force the cells of a face press back on the hand, as a world of pieces tells it.
namespace thimble::world::cam {
namespace {

using std::chrono::milliseconds;
using test::at;
using test::kCell_m;
using test::kSpace;
using test::two_squares;

constexpr double kEach_newton_per_m = 10;  // of a cell

using PiecePressure = test::HandInWorld;

PieceWorldSettings with_pressure() {
  return {.pieces = {.space = kSpace}, .pressure = Stiffness{kEach_newton_per_m}};
}

// What comes of the plane alone.
Force3 force_of(const ProbeMotion& motion, Position3 hand) {
  Force3 out;
  for (const ContactPlane& plane : motion.planes) {
    if (plane.stiffness.newton_per_m < 0) continue;
    const double depth_m = dot(plane.normal, hand - Position3{}) - plane.offset_m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out[axis] -= plane.stiffness.newton_per_m * depth_m * plane.normal[axis];
    }
  }
  return out;
}

TEST_F(PiecePressure, IsWhatTheCellsOfAFaceMakeOfTheDepthOfTheHandBehindIt) {
  begin(with_pressure(), two_squares());
  hold(at(16, 16));
  for (const int depth_cells : {1, 2, 5}) {
    const Position3 hand = at(12 - depth_cells, 15);
    const ProbeMotion finger = hold(hand);
    ASSERT_TRUE(finger.has_pressure);
    EXPECT_NEAR(finger.pressure.x, kEach_newton_per_m * (depth_cells - 0.5) * kCell_m, 1e-12);
    EXPECT_EQ(finger.pressure.y, 0);
    EXPECT_EQ(finger.pressure.z, 0);
  }
  ASSERT_EQ(act(PieceAction::Select, at(9, 15)), PieceOutcome::Selected);
  const ProbeMotion piece = hold(at(22, 15), milliseconds(60));
  ASSERT_TRUE(piece.has_pressure);
  const double depth_m = at(22, 15).x - piece.planes[0].offset_m;
  EXPECT_GT(depth_m, kCell_m);
  EXPECT_NEAR(piece.pressure.x, -4 * kEach_newton_per_m * depth_m, 1e-12)
      << "four cells overlap, and it is on the other side";
}

TEST_F(PiecePressure, FollowsEveryHandThatIsToldAndNotOnlyThoseThatTheBoardLookedFor) {
  begin(with_pressure(), two_squares());
  hold(at(16, 16));
  Position3 hand = at(9, 15);
  const Force3 before = hold(hand).pressure;
  hand.x += 0.3 * kCell_m;  // in the same cell: nothing to look for
  const ProbeMotion nearer = world_->move_probe(probe_, hand, milliseconds(1));
  EXPECT_NEAR(nearer.pressure.x, before.x - kEach_newton_per_m * 0.3 * kCell_m, 1e-12);
  // Out of the face, which holds until the board has looked: nothing pulls.
  const ProbeMotion out = world_->move_probe(probe_, at(14, 15), milliseconds(1));
  ASSERT_EQ(out.planes.size(), 1U);
  EXPECT_TRUE(out.has_pressure);
  EXPECT_EQ(out.pressure, Force3{});
  EXPECT_FALSE(hold(at(14, 15)).has_pressure);
}

TEST_F(PiecePressure, IsToldOfNoFaceWhoseCellsAreNotCounted) {
  begin({.pieces = {.space = kSpace}}, two_squares());
  hold(at(16, 16));
  const ProbeMotion plain = hold(at(9, 15));
  ASSERT_EQ(plain.planes.size(), 1U);
  EXPECT_FALSE(plain.has_pressure) << "nobody asked for it";
  begin(with_pressure(), two_squares());
  EXPECT_FALSE(world_->move_probe(probe_, at(16, 16), milliseconds(1)).has_pressure) << "silent";
  EXPECT_FALSE(hold(at(16, 16)).has_pressure) << "free";
  EXPECT_FALSE(hold(at(16, 33)).has_pressure) << "the edge of the world";
}

// A turn of the plane by mirrors and a swap of its axes: all eight that map it onto itself.
struct Turn {
  bool mirrors_x{false};
  bool mirrors_y{false};
  bool swaps{false};

  template <class Vector>
  [[nodiscard]] Vector of(Vector v) const {
    if (mirrors_x) v.x = -v.x;
    if (mirrors_y) v.y = -v.y;
    if (swaps) std::swap(v.x, v.y);
    return v;
  }
  [[nodiscard]] PieceLayout of(const PieceLayout& layout) const {
    PieceLayout out(layout.size());
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        int to_x = mirrors_x ? 31 - x : x;
        int to_y = mirrors_y ? 31 - y : y;
        if (swaps) std::swap(to_x, to_y);
        out[index_of(kSpace, {to_x, to_y, 0})] = layout[index_of(kSpace, {x, y, 0})];
      }
    }
    return out;
  }
};

// Around a corner that lies open to the middle, and two pieces.
PieceLayout corner() {
  PieceLayout layout = two_squares();
  for (int i = 2; i < 30; ++i) {
    for (int across = 2; across < 4; ++across) {
      layout[index_of(kSpace, {i, across, 0})] = 3;
      layout[index_of(kSpace, {across, i, 0})] = 3;
    }
  }
  return layout;
}

TEST_F(PiecePressure, OfAMirroredAndPermutedWorldIsMirroredAndPermutedBitForBit) {
  std::array<Force3, 3> plain{};
  for (unsigned which = 0; which < 8; ++which) {
    const Turn turn{(which & 1U) != 0, (which & 2U) != 0, (which & 4U) != 0};
    begin(with_pressure(), turn.of(corner()));
    const auto pressure_at = [&](int x, int y) {
      const Position3 hand = turn.of(at(x, y));
      const ProbeMotion motion = hold(hand, milliseconds(60));
      EXPECT_TRUE(motion.has_pressure) << which;
      EXPECT_LT(norm(motion.pressure - force_of(motion, hand)), 1e-12) << which;
      return motion.pressure;
    };
    hold(turn.of(at(16, 8)));
    hold(turn.of(at(6, 8)), milliseconds(60));
    const Force3 in_the_corner = pressure_at(1, 3);
    hold(turn.of(at(16, 8)), milliseconds(60));
    hold(turn.of(at(16, 15)), milliseconds(60));
    const Force3 at_a_face = pressure_at(9, 15);
    ASSERT_EQ(act(PieceAction::Select, turn.of(at(9, 15))), PieceOutcome::Selected) << which;
    const Force3 by_a_piece = pressure_at(22, 14);
    const std::array<Force3, 3> all{in_the_corner, at_a_face, by_a_piece};
    if (which == 0) {
      plain = all;
      EXPECT_GT(in_the_corner.x, 0);
      EXPECT_GT(in_the_corner.y, 0);
    }
    for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], turn.of(plain[i])) << which;
  }
}

}  // namespace
}  // namespace thimble::world::cam
