#include "daemon/coupling/buffer_zone_arm.hpp"

#include <algorithm>

#include "daemon/coupling/wall_penalty.hpp"

namespace thimble::coupling {
namespace {

bool is_usable(const ConstraintSet& set) noexcept {
  return !set.has_near || (set.has_ghost && world::is_sound(set.near, set.ghost));
}

bool is_behind_any(const PlaneList& planes, Position3 tip) noexcept {
  return std::any_of(planes.begin(), planes.end(), [tip](const ConstraintPlane& plane) {
    return dot(plane.normal, tip) > plane.offset_m;
  });
}

}  // namespace

BufferZoneArm::BufferZoneArm(const BufferZoneSettings& settings) noexcept
    : tool_(settings.tool), port_(settings.age) {}

void BufferZoneArm::restart(MonotonicTime now, Position3 tip) noexcept {
  port_.reset(now, tip);
  forget();
}

void BufferZoneArm::forget() noexcept {
  planes_.clear();
  has_ghost_ = false;
}

ArmOutput BufferZoneArm::advance(const ArmInput& input) noexcept {
  if (!is_finite(input.tip) || !is_finite(input.tip_velocity)) return port_.refuse(input);
  const ConstraintSet* const said =
      port_.hear(input, input.fresh != nullptr && is_usable(*input.fresh));
  if (port_.is_new_epoch()) forget();
  if (said != nullptr) learn(*said);
  if (has_ghost_) follow(input.tip);

  const Force3 wish = wall_penalty(planes_, tool_, input.tip, input.tip_velocity);
  ArmOutput output = port_.show(input, wish, is_behind_any(planes_, input.tip), tool_);
  output.sample.ghost = ghost_.position;
  output.sample.has_ghost = has_ghost_;
  output.is_foretold = true;
  return output;
}

void BufferZoneArm::learn(const ConstraintSet& said) noexcept {
  if (!said.has_near) {
    has_ghost_ = false;
    planes_ = said.planes;
    return;
  }
  if (said.near.lattice != near_.lattice) has_ghost_ = false;  // its cell is of other cells
  near_ = said.near;
  // What the world says of a sample from before the ghost was put right is no news.
  const bool is_astray = said.is_astray && said.answers > seated_at_;
  const bool is_in_the_open = near_.is_known(ghost_.cell) && !near_.is_occupied(ghost_.cell);
  if (has_ghost_ && !is_astray && is_in_the_open) return;
  if (has_ghost_) ++corrections_;
  ghost_ = {said.ghost, near_.middle};
  seated_at_ = port_.sequence() - 1;
  has_ghost_ = true;
}

void BufferZoneArm::follow(Position3 tip) noexcept {
  Position3 target = tip;
  if (near_.is_plane) {
    target.z = 0;
    ghost_.position.z = 0;
  }
  const world::Slide slide = slide_ghost(near_, ghost_, target);
  ghost_ = slide.ghost;
  if (near_.is_plane) ghost_.position.z = tip.z;
  planes_.clear();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (slide.held[axis] == 0) continue;
    ConstraintPlane plane;
    plane.normal[axis] = slide.held[axis];
    plane.offset_m = slide.held[axis] * ghost_.position[axis];
    planes_.push_back(plane);
  }
}

}  // namespace thimble::coupling
