#include "daemon/coupling/probe_in_world.hpp"

#include <algorithm>
#include <utility>

namespace thimble::coupling {

Result<void> ProbeInWorld::open(const HandSample& first) {
  if (!is_finite(first.hand)) return fail(Errc::InvalidArgument, "hand position is not finite");
  close();
  const Result<world::ProbeId> probe = world_.add_probe(first.hand);
  if (!probe) return tl::unexpected<Error>(probe.error());
  probe_ = *probe;
  buttons_ = first.buttons;
  return {};
}

void ProbeInWorld::press(std::uint32_t buttons) noexcept {
  const std::uint32_t before = std::exchange(buttons_, buttons);
  world_.press(*probe_, buttons & ~before);
}

world::ProbeMotion ProbeInWorld::move(Position3 at, Duration dt) noexcept {
  return world_.move_probe(*probe_, at, std::max(dt, Duration(1)));
}

void ProbeInWorld::close() noexcept {
  if (!probe_) return;
  world_.remove_probe(*probe_);
  probe_.reset();
}

}  // namespace thimble::coupling
