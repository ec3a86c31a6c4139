#include "daemon/coupling/slave.hpp"

#include "daemon/coupling/tell.hpp"

namespace thimble::coupling {

Result<void> Slave::open(const HandSample& first) {
  if (Result<void> opened = probe_.open(first); !opened) return opened;
  at_ = first.hand;
  velocity_ = {};
  around_ = {.ghost = first.hand};
  planes_.clear();
  return {};
}

bool Slave::look_around(Duration dt) noexcept {
  const world::ProbeMotion motion = probe_.move(at_, dt);
  if (motion.is_silent) {
    velocity_ = {};
    return false;
  }
  around_ = motion;
  planes_ = planes_of(motion);
  return true;
}

void Slave::move(Force3 pull, double step_s) noexcept {
  const Force3 force = pull + wall_force();
  const double share = step_s / settings_.mass_kg;
  velocity_ += {share * force.x, share * force.y, share * force.z};
  at_ = at_ + Displacement3{step_s * velocity_.x, step_s * velocity_.y, step_s * velocity_.z};
}

void Slave::tell(const HandSample& sample, ConstraintSet& set) const noexcept {
  coupling::tell(around_, sample, set);
  set.ghost = around_.ghost;
  set.has_ghost = true;
  set.has_far = true;
  set.far.slave = at_;
  set.far.velocity = velocity_;
  set.far.is_pressing = wall_force() != Force3{};
}

}  // namespace thimble::coupling
