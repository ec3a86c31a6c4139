#include "daemon/coupling/ghost_point_world.hpp"

#include <algorithm>
#include <utility>

#include "daemon/coupling/tell.hpp"

namespace thimble::coupling {

GhostPointWorld::GhostPointWorld(world::World& world, std::uint32_t first_session) noexcept
    : world_(world), next_session_(first_session) {}

GhostPointWorld::~GhostPointWorld() { GhostPointWorld::close(); }

Result<void> GhostPointWorld::open(const HandSample& first) {
  if (!is_finite(first.hand)) return fail(Errc::InvalidArgument, "hand position is not finite");
  close();
  const Result<world::ProbeId> probe = world_.add_probe(first.hand);
  if (!probe) return tl::unexpected<Error>(probe.error());
  probe_ = *probe;
  last_ = {};
  last_.session = next_session_++;
  buttons_ = first.buttons;
  return {};
}

ConstraintSet GhostPointWorld::answer(const HandSample& sample, Duration dt) noexcept {
  if (!probe_ || !is_finite(sample.hand)) return last_;
  const std::uint32_t before = std::exchange(buttons_, sample.buttons);
  world_.press(*probe_, sample.buttons & ~before);
  const world::ProbeMotion motion =
      world_.move_probe(*probe_, sample.hand, std::max(dt, Duration(1)));
  if (motion.is_silent) return last_;
  tell(motion, sample, last_);
  last_.ghost = motion.ghost;
  last_.has_ghost = true;
  return last_;
}

void GhostPointWorld::close() noexcept {
  if (!probe_) return;
  world_.remove_probe(*probe_);
  probe_.reset();
}

}  // namespace thimble::coupling
