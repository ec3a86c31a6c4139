#include "daemon/world/simple_constraints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace thimble::world {
namespace {

// Which way the hand has yet to go along one axis, and how far beyond the next face it is.
struct Crossing {
  std::int8_t way{0};
  double beyond_m{0};
};

[[nodiscard]] Crossing next_crossing(const VoxelGrid& grid, const SimpleConstraints& state,
                                     std::size_t axis) noexcept {
  const double above_m = state.hand[axis] - grid.face_m(axis, state.cell[axis] + 1);
  const double below_m = grid.face_m(axis, state.cell[axis]) - state.hand[axis];
  if (above_m > 0) return {1, above_m};
  if (below_m > 0) return {-1, below_m};
  return {};
}

void constrain(const VoxelGrid& grid, SimpleConstraints& state, Cell from,
               std::size_t axis) noexcept {
  const std::int32_t step = state.cell[axis] - from[axis];
  if (step == 0 || state.way[axis] != 0) return;
  if (grid.is_occupied(from) || !grid.is_occupied(state.cell)) return;
  state.way[axis] = static_cast<std::int8_t>(step);
  state.face[axis] = step > 0 ? state.cell[axis] : from[axis];
}

void release(SimpleConstraints& state, std::size_t axis) noexcept {
  const std::int8_t side = state.cell[axis] < state.face[axis] ? 1 : -1;
  if (state.way[axis] == side) state.way[axis] = 0;
}

// Takes the cell through the next face on the way to the hand, or through several that are met at
// the same instant. The face with the largest share of the way left behind it is the next.
// False: the hand is in this cell.
bool step_to_hand(const VoxelGrid& grid, SimpleConstraints& state, Displacement3 way) noexcept {
  std::array<std::int8_t, 3> step{};
  std::array<double, 3> share_left{};
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Crossing crossing = next_crossing(grid, state, axis);
    step[axis] = crossing.way;
    // A hand that appeared outside the grid has its wall behind it already.
    if (crossing.way == 0) continue;
    share_left[axis] = way[axis] == 0 ? std::numeric_limits<double>::infinity()
                                      : crossing.beyond_m / std::abs(way[axis]);
    largest = std::max(largest, share_left[axis]);
  }
  if (largest == 0) return false;
  const Cell from = state.cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (share_left[axis] == largest) state.cell[axis] += step[axis];
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    release(state, axis);
    constrain(grid, state, from, axis);
  }
  return true;
}

}  // namespace

SimpleConstraints start_simple_constraints(const VoxelGrid& grid, Position3 hand) noexcept {
  SimpleConstraints state;
  if (is_finite(hand)) state.hand = grid.clamp_near(hand);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    state.cell[axis] = grid.lower_index(axis, state.hand[axis]);
  }
  return state;
}

ProbeMotion constrain_simply(const VoxelGrid& grid, SimpleConstraints& state,
                             Position3 hand) noexcept {
  if (!is_finite(hand)) return {state.hand, {}, false};
  const Position3 target = grid.clamp_near(hand);
  const Displacement3 way = target - state.hand;
  state.hand = target;
  while (step_to_hand(grid, state, way)) {
  }
  ProbeMotion motion{hand, {}, false};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (state.way[axis] == 0) continue;
    ContactPlane plane;
    plane.normal[axis] = state.way[axis];
    plane.offset_m = state.way[axis] * grid.face_m(axis, state.face[axis]);
    motion.planes.push_back(plane);
  }
  motion.is_embedded = motion.planes.empty() && grid.is_occupied(state.cell);
  return motion;
}

}  // namespace thimble::world
