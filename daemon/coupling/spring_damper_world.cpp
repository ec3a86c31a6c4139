#include "daemon/coupling/spring_damper_world.hpp"

namespace thimble::coupling {

Result<void> SpringDamperWorld::open(const HandSample& first) {
  if (Result<void> opened = slave_.open(first); !opened) return opened;
  goal_ = first;
  goal_.sequence = 0;  // the same sample may be answered, too
  goal_.velocity = {};
  goal_.tool = {};
  last_ = {};
  last_.session = next_session_++;
  return {};
}

ConstraintSet SpringDamperWorld::answer(const HandSample& sample, Duration dt) noexcept {
  if (!slave_.is_open()) return last_;
  const bool can_see = slave_.advance(
      dt, [this](Position3 at, Velocity3 velocity, double /*s*/) { return pull(at, velocity); });
  if (!is_finite(sample.hand) || !is_finite(sample.velocity)) return last_;
  if (sample.sequence <= goal_.sequence) return last_;
  slave_.hear(sample);
  goal_ = sample;
  goal_.tool = sound_tool(sample.tool, kHardestController);
  if (!can_see) return last_;
  slave_.tell(sample, last_);
  if (force_at_ == ForceAt::World) last_.far.force = -pull(slave_.at(), slave_.velocity());
  return last_;
}

Force3 SpringDamperWorld::pull(Position3 at, Velocity3 velocity) const noexcept {
  const Force3 spring = goal_.tool.stiffness * (goal_.hand - at);
  const Damping& damping = goal_.tool.damping;
  if (force_at_ == ForceAt::Both) return spring - damping * velocity;
  return spring + kDampingShare * (damping * (goal_.velocity - velocity));
}

}  // namespace thimble::coupling
