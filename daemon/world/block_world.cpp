#include "daemon/world/block_world.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace thimble::world {
namespace {

// Where a straight way goes through a face of a box for the first time.
struct Entry {
  double share{2};  // of the way; above 1: not on it
  std::size_t axis{0};
};

// Open box: who only touches a face is outside. A start inside is no entry.
Entry entry_of(Position3 from, Displacement3 way, Position3 low, Position3 high) noexcept {
  double in = -1;
  double out = 2;
  Entry entry;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double near_m = (way[axis] > 0 ? low[axis] : high[axis]) - from[axis];
    const double far_m = (way[axis] > 0 ? high[axis] : low[axis]) - from[axis];
    if (way[axis] == 0) {
      if (!(from[axis] > low[axis] && from[axis] < high[axis])) return {};
      continue;
    }
    if (near_m / way[axis] > in) {
      in = near_m / way[axis];
      entry.axis = axis;
    }
    out = std::min(out, far_m / way[axis]);
  }
  if (in >= 0 && in < 1 && in < out) entry.share = in;
  return entry;
}

}  // namespace

BlockWorld::BlockWorld(const BlockScene& scene)
    : half_room_m_(scene.room_m / 2),
      half_m_(scene.edge_m / 2),
      drag_newton_s_per_m_(scene.drag_newton_s_per_m) {
  info_.source = "block";
  info_.extent_m = {scene.room_m, scene.room_m, scene.room_m};
  info_.block = scene;
}

Result<BlockWorld> BlockWorld::create(const BlockScene& scene) {
  const auto is_positive = [](double number) { return std::isfinite(number) && number > 0; };
  if (!is_positive(scene.room_m) || !is_positive(scene.edge_m) ||
      !is_positive(scene.drag_newton_s_per_m) || !(scene.edge_m < scene.room_m)) {
    return fail(Errc::InvalidArgument,
                "block: its edge, the room's and the drag must be above 0, and the block smaller "
                "than its room");
  }
  return BlockWorld(scene);
}

Result<ProbeId> BlockWorld::add_probe(Position3 hand) {
  if (!is_finite(hand)) return fail(Errc::InvalidArgument, "probe: the hand's place is not finite");
  for (auto& slot : probes_) {
    if (slot) continue;
    Position3 start = hand;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      start[axis] = std::clamp(start[axis], -half_room_m_, half_room_m_);
    }
    slot = Probe{{++last_id_}, out_of_block(start)};
    return slot->id;
  }
  return fail(Errc::Busy, info_.source + ": all " + std::to_string(kMaxProbes) +
                              " probes of the world are taken");
}

void BlockWorld::remove_probe(ProbeId probe) noexcept {
  if (auto* slot = find(probe)) slot->reset();
}

ProbeMotion BlockWorld::move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept {
  auto* slot = find(probe);
  if (slot == nullptr) return {hand, {}, false};
  Position3& ghost = (*slot)->ghost;
  ProbeMotion motion;
  motion.ghost = ghost;
  if (!is_finite(hand)) return motion;
  give_way(slide(ghost, hand), hand, dt);
  const Held held = slide(ghost, hand);
  motion.ghost = ghost;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int sign = held.by_block[axis] != 0 ? held.by_block[axis] : held.by_room[axis];
    if (sign == 0) continue;
    ContactPlane plane;
    plane.normal[axis] = sign;
    plane.offset_m = sign * ghost[axis];
    motion.planes.push_back(plane);
  }
  return motion;
}

bool BlockWorld::is_in_block(Position3 p) const noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(p[axis] > low_m(axis) && p[axis] < high_m(axis))) return false;
  }
  return true;
}

// To the nearest face that is not flush with the room: it leaves place for a point.
Position3 BlockWorld::out_of_block(Position3 p) const noexcept {
  if (!is_in_block(p)) return p;
  Position3 best = p;
  double least_m = 4 * half_room_m_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double face_m : {low_m(axis), high_m(axis)}) {
      const bool is_flush = std::abs(face_m) >= half_room_m_;
      if (is_flush || std::abs(face_m - p[axis]) >= least_m) continue;
      least_m = std::abs(face_m - p[axis]);
      best = p;
      best[axis] = face_m;
    }
  }
  return best;
}

// Straight to the hand, and along what is in the way.
BlockWorld::Held BlockWorld::slide(Position3& ghost, Position3 hand) const noexcept {
  Held held;
  Position3 target = hand;
  Position3 low;
  Position3 high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    target[axis] = std::clamp(hand[axis], -half_room_m_, half_room_m_);
    if (target[axis] != hand[axis]) held.by_room[axis] = hand[axis] > 0 ? 1 : -1;
    low[axis] = low_m(axis);
    high[axis] = high_m(axis);
  }
  for (int pass = 0; pass < 3; ++pass) {
    const Displacement3 way = target - ghost;
    const Entry entry = entry_of(ghost, way, low, high);
    if (entry.share > 1) {
      ghost = target;
      return held;
    }
    const std::size_t axis = entry.axis;
    ghost = ghost + entry.share * way;
    ghost[axis] = way[axis] > 0 ? low[axis] : high[axis];
    target[axis] = ghost[axis];
    held.by_block[axis] = way[axis] > 0 ? 1 : -1;
  }
  return held;
}

void BlockWorld::give_way(const Held& held, Position3 hand, Duration dt) noexcept {
  const double share =
      1 - std::exp(-kPush_newton_per_m * std::max(0.0, seconds(dt)) / drag_newton_s_per_m_);
  const double most_m = half_room_m_ - half_m_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (held.by_block[axis] == 0) continue;
    const double face_m = held.by_block[axis] > 0 ? low_m(axis) : high_m(axis);
    const double before_m = center_[axis];
    // No further than the hand reaches in the room: who pushes past it pushes the wall.
    const double reach_m = std::clamp(hand[axis], -half_room_m_, half_room_m_) - face_m;
    center_[axis] = std::clamp(before_m + share * reach_m, -most_m, most_m);
    take_along(axis, center_[axis] - before_m);
  }
}

// Ghosts that it met on its way are on its face.
void BlockWorld::take_along(std::size_t axis, double moved_m) noexcept {
  if (moved_m == 0) return;
  for (auto& slot : probes_) {
    if (!slot || !is_in_block(slot->ghost)) continue;
    slot->ghost[axis] = moved_m > 0 ? high_m(axis) : low_m(axis);
  }
}

std::optional<BlockWorld::Probe>* BlockWorld::find(ProbeId id) noexcept {
  for (auto& slot : probes_) {
    if (slot && slot->id == id) return &slot;
  }
  return nullptr;
}

}  // namespace thimble::world
