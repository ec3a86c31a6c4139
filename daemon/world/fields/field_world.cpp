#include "daemon/world/fields/field_world.hpp"

#include <utility>

namespace thimble::world {

FieldWorld::FieldWorld(DistanceField field, std::string source, const Material& surface)
    : field_(std::move(field)), surface_(surface) {
  info_.source = std::move(source);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    info_.extent_m[axis] = (field_.numbers()[axis] - 1) * field_.step_m();
  }
}

Result<ProbeId> FieldWorld::add_probe(Position3 hand) {
  if (!is_finite(hand)) return fail(Errc::InvalidArgument, "probe: the hand's place is not finite");
  const std::optional<Position3> place = find_place(field_, hand);
  if (!place)
    return fail(Errc::NotFound, info_.source + ": the field has no free place near the hand");
  return probes_.add(*place, info_.source);
}

ProbeMotion FieldWorld::move_probe(ProbeId probe, Position3 hand, Duration /*dt*/) noexcept {
  Position3* const ghost = probes_.find(probe);
  if (ghost == nullptr) return {hand, {}, false};
  return move_ghost(field_, surface_, *ghost, hand);
}

}  // namespace thimble::world
