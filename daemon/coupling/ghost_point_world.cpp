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
  if (probe_.is_open()) (void)follow_and_tell(probe_, sample, dt, last_);
  return last_;
}

}  // namespace thimble::coupling
