#include "daemon/world/ghost_motion.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "daemon/world/push_out.hpp"

namespace thimble::world {
namespace {

[[nodiscard]] ContactPlane plane_across(std::size_t axis, double way, double at_m) noexcept {
  ContactPlane plane;
  plane.normal[axis] = way;
  plane.offset_m = way * at_m;
  return plane;
}

ProbeMotion settle(GhostState& state, const Slide& slide, Position3 hand) noexcept {
  state.point = slide.ghost;
  state.is_held_back = state.point.position != hand;
  // Out of matter; whoever was caught in it may turn back through it until the hand is reached.
  if (state.phase != GhostPhase::Caught || !state.is_held_back) state.phase = GhostPhase::Loose;
  ProbeMotion motion{state.point.position, {}, false};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (slide.held[axis] == 0) continue;
    motion.planes.push_back(plane_across(axis, slide.held[axis], state.point.position[axis]));
  }
  return motion;
}

// The cell on the way: on a face still the one it came from.
void follow_cell(const VoxelGrid& grid, GhostPoint& point) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = point.position[axis];
    const std::int32_t lower = grid.lower_index(axis, at);
    const bool is_from_above = point.cell[axis] > lower;
    point.cell[axis] = is_from_above && at == grid.face_m(axis, lower + 1) ? lower + 1 : lower;
  }
}

ProbeMotion follow_hand(const VoxelGrid& grid, GhostState& state, Position3 hand) noexcept {
  state.point.position = hand;
  follow_cell(grid, state.point);
  state.phase = GhostPhase::Released;
  state.is_held_back = false;
  return {hand, {}, true};
}

[[nodiscard]] std::optional<Exit> find_exit_from(const VoxelGrid& grid, const GhostState& state,
                                                 Position3 anchor, Position3 hand,
                                                 std::int32_t reach) noexcept {
  // Both near the world, lest a hand at 1e300 m overflows.
  const Displacement3 pull = grid.clamp_near(hand) - grid.clamp_near(state.point.position);
  // A wall that is being pressed lies towards the hand: what is free behind it is no way out.
  const bool is_bound = state.phase == GhostPhase::Pressed;
  return find_exit(grid, {anchor, is_bound ? -pull : pull, is_bound, state.point.cell, reach});
}

// The free cell that the hand is in, if there is one to choose.
[[nodiscard]] std::optional<GhostPoint> free_place_of_hand(const VoxelGrid& grid,
                                                           const GhostState& state,
                                                           Position3 hand) noexcept {
  const auto exit = find_exit_from(grid, state, hand, hand, /*reach=*/0);
  if (!exit || exit->distance_m != 0) return std::nullopt;
  return exit->at;
}

ProbeMotion push_out(const VoxelGrid& grid, GhostState& state, Position3 hand,
                     Duration dt) noexcept {
  Position3& ghost = state.point.position;
  const Position3 anchor = state.phase == GhostPhase::Caught ? grid.clamp_near(hand) : ghost;
  const auto exit = find_exit_from(grid, state, anchor, hand, kPushOutReach);
  if (!exit) return follow_hand(grid, state, hand);

  const Displacement3 rest = exit->at.position - ghost;
  const double distance_m =
      std::sqrt(symmetric_sum(rest.x * rest.x, rest.y * rest.y, rest.z * rest.z));
  const double step_m = kPushOutSpeed_m_s * std::max(0.0, seconds(dt));
  if (step_m >= distance_m) {
    return settle(state, slide_ghost(grid, exit->at, hand), hand);
  }
  ghost = ghost + rest * (step_m / distance_m);
  follow_cell(grid, state.point);
  state.is_held_back = ghost != hand;
  ProbeMotion motion{ghost, {}, true};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (exit->at.position[axis] == anchor[axis]) continue;
    const double obstacle_way = exit->at.position[axis] > anchor[axis] ? -1 : 1;
    motion.planes.push_back(plane_across(axis, obstacle_way, ghost[axis]));
  }
  return motion;
}

}  // namespace

ProbeMotion move_ghost(const VoxelGrid& grid, GhostState& state, Position3 hand,
                       Duration dt) noexcept {
  if (!is_finite(hand)) return {state.point.position, {}, grid.is_occupied(state.point.cell)};
  const bool is_in_matter = grid.is_occupied(state.point.cell);
  if (is_in_matter && state.phase == GhostPhase::Loose) {
    state.phase = state.is_held_back ? GhostPhase::Pressed : GhostPhase::Caught;
  }
  if (state.phase == GhostPhase::Caught || state.phase == GhostPhase::Released) {
    if (const auto place = free_place_of_hand(grid, state, hand)) {
      state.phase = GhostPhase::Loose;
      return settle(state, slide_ghost(grid, *place, hand), hand);
    }
    if (state.phase == GhostPhase::Released) return follow_hand(grid, state, hand);
  }
  const Slide slide = slide_ghost(grid, state.point, hand);
  if (!is_in_matter || slide.ghost.cell != state.point.cell) return settle(state, slide, hand);
  return push_out(grid, state, hand, dt);
}

}  // namespace thimble::world
