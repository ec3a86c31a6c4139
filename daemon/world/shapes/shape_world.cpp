#include "daemon/world/shapes/shape_world.hpp"

#include <string>

namespace thimble::world {

ShapeWorld::ShapeWorld() { info_.source = "shapes"; }

Result<ShapeWorld> ShapeWorld::create(const std::vector<Shape>& shapes) {
  if (shapes.empty() || shapes.size() > kMaxShapes) {
    return fail(Errc::InvalidArgument, "shapes: expected 1 to " + std::to_string(kMaxShapes) +
                                           " of them, found " + std::to_string(shapes.size()));
  }
  ShapeWorld world;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!PlacedShape::is_sound(shapes[i])) {
      return fail(Errc::InvalidArgument,
                  "shapes: number " + std::to_string(i) + " is not finite, or smaller than 1 mm");
    }
    world.shapes_.emplace_back(shapes[i]);
  }
  return world;
}

Result<ProbeId> ShapeWorld::add_probe(Position3 hand) {
  if (!is_finite(hand)) return fail(Errc::InvalidArgument, "probe: the hand's place is not finite");
  for (auto& slot : probes_) {
    if (slot) continue;
    const std::optional<Position3> place = find_place(shapes_, hand);
    if (!place) return fail(Errc::NotFound, "shapes: no free place near the hand");
    slot = Probe{{++last_id_}, *place};
    return slot->id;
  }
  return fail(Errc::Busy, info_.source + ": all " + std::to_string(kMaxProbes) +
                              " probes of the world are taken");
}

void ShapeWorld::remove_probe(ProbeId probe) noexcept {
  if (auto* slot = find(probe)) slot->reset();
}

ProbeMotion ShapeWorld::move_probe(ProbeId probe, Position3 hand, Duration /*dt*/) noexcept {
  auto* slot = find(probe);
  if (slot == nullptr) return {hand, {}, false};
  return move_ghost(shapes_, (*slot)->ghost, hand);
}

std::optional<ShapeWorld::Probe>* ShapeWorld::find(ProbeId id) noexcept {
  for (auto& slot : probes_) {
    if (slot && slot->id == id) return &slot;
  }
  return nullptr;
}

}  // namespace thimble::world
