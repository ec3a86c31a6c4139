#include "daemon/coupling/ghost_point_world.hpp"

#include "daemon/coupling/tell.hpp"

namespace thimble::coupling {

GhostPointWorld::GhostPointWorld(world::World& world, std::uint32_t first_session) noexcept
    : probe_(world), next_session_(first_session) {}

Result<void> GhostPointWorld::open(const HandSample& first) {
  if (Result<void> opened = probe_.open(first); !opened) return opened;
  last_ = {};
  last_.session = next_session_++;
  return {};
}

ConstraintSet GhostPointWorld::answer(const HandSample& sample, Duration dt) noexcept {
  if (!probe_.is_open() || !is_finite(sample.hand)) return last_;
  probe_.press(sample.buttons);
  const world::ProbeMotion motion = probe_.move(sample.hand, dt);
  if (motion.is_silent) return last_;
  tell(motion, sample, last_);
  last_.ghost = motion.ghost;
  last_.has_ghost = true;
  return last_;
}

}  // namespace thimble::coupling
