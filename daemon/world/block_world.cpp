#include "daemon/world/block_world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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
      oil_{.stiffness_newton_per_m = kPush_newton_per_m,
           .drag_newton_s_per_m = scene.drag_newton_s_per_m,
           .friction = scene.friction,
           .most_m = half_room_m_ - half_m_},
      weight_(scene.weight) {
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
  if (!(scene.friction >= 0 && scene.friction <= 1) || !is_finite(scene.weight)) {
    return fail(Errc::InvalidArgument, "block: its friction must be 0 to 1, and its weight finite");
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
    slot = Probe{{++last_id_}, out_of_block(start), {}};
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
  auto& [id, ghost, grip] = **slot;
  ProbeMotion motion;
  motion.ghost = ghost;
  if (!is_finite(hand)) return motion;
  give_way(**slot, slide(ghost, hand), hand, dt);
  const Held held = slide(ghost, hand);
  motion.ghost = ghost;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int sign = held.by_block[axis] != 0 ? held.by_block[axis] : held.by_room[axis];
    if (sign == 0) continue;
    ContactPlane plane;
    plane.normal[axis] = sign;
    plane.offset_m = sign * ghost[axis];
    if (held.by_block[axis] != 0) plane.friction = told_friction(grip);
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

// What holds a ghost is one face of the block at most, for a point goes through one at a time.
void BlockWorld::give_way(Probe& probe, const Held& held, Position3 hand, Duration dt) noexcept {
  const double dt_s = std::max(0.0, seconds(dt));
  const auto probes = std::count_if(probes_.begin(), probes_.end(),
                                    [](const auto& slot) { return slot.has_value(); });
  const Force3 weight = (1.0 / static_cast<double>(probes)) * weight_;
  std::size_t axis = 0;
  while (axis < 3 && held.by_block[axis] == 0) ++axis;
  if (axis == 3) {
    probe.grip.reset();
    go_to(sink_block(oil_, center_, weight, dt_s));
    return;
  }
  BlockHold hold{.axis = axis, .sign = held.by_block[axis]};
  const double face_m = hold.sign > 0 ? low_m(axis) : high_m(axis);
  // No further than the hand reaches in the room: who pushes past it pushes the wall.
  hold.depth_m = hold.sign * (std::clamp(hand[axis], -half_room_m_, half_room_m_) - face_m);
  // Along the face the ghost is where the hand is.
  const bool sticks = probe.grip && probe.grip->axis == axis && probe.grip->sign == hold.sign;
  if (sticks && oil_.friction > 0) hold.stretch = probe.ghost - center_ - probe.grip->foot;
  hold.stretch[axis] = 0;
  const BlockMotion motion = push_block(oil_, hold, center_, weight, dt_s);
  probe.grip = Grip{axis, hold.sign, probe.ghost - motion.center - motion.hold.stretch, 0};
  if (motion.hold.depth_m > 0) {
    probe.grip->friction = std::min(oil_.friction, norm(motion.hold.stretch) / motion.hold.depth_m);
  }
  go_to(motion.center);
}

// A world without friction leaves it to the arm.
double BlockWorld::told_friction(const std::optional<Grip>& grip) const noexcept {
  if (!(oil_.friction > 0)) return -1;
  return grip ? grip->friction : 0;
}

// Ghosts that it met on its way are on its face: of those it went with, the one that came last.
void BlockWorld::go_to(Position3 center) noexcept {
  const Displacement3 way = center - center_;
  center_ = center;
  if (way == Displacement3{}) return;
  for (auto& slot : probes_) {
    if (!slot || !is_in_block(slot->ghost)) continue;
    std::size_t met = 0;
    double least_share = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (way[axis] == 0) continue;
      const double face_m = way[axis] > 0 ? high_m(axis) : low_m(axis);
      const double share = (face_m - slot->ghost[axis]) / way[axis];
      if (share >= least_share) continue;
      least_share = share;
      met = axis;
    }
    slot->ghost[met] = way[met] > 0 ? high_m(met) : low_m(met);
  }
}

std::optional<BlockWorld::Probe>* BlockWorld::find(ProbeId id) noexcept {
  for (auto& slot : probes_) {
    if (slot && slot->id == id) return &slot;
  }
  return nullptr;
}

}  // namespace thimble::world
