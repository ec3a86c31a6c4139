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
  const std::optional<Position3> place = find_place(shapes_, hand);
  if (!place) return fail(Errc::NotFound, "shapes: no free place near the hand");
  return probes_.add(*place, info_.source);
}

void ShapeWorld::remove_probe(ProbeId probe) noexcept { probes_.remove(probe); }

ProbeMotion ShapeWorld::move_probe(ProbeId probe, Position3 hand, Duration /*dt*/) noexcept {
  Position3* const ghost = probes_.find(probe);
  if (ghost == nullptr) return {hand, {}, false};
  return move_ghost(shapes_, *ghost, hand);
}

}  // namespace thimble::world
