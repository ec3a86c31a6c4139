#pragma once

#include <vector>

#include "daemon/world/probe_slots.hpp"
#include "daemon/world/shapes/shape_motion.hpp"
#include "daemon/world/world.hpp"

namespace thimble::world {

// A world made of shapes (thesis 3.7.2): their union is matter, everything else is free, without
// end. Its faces are tangent planes, which lie any way.
//
// Thread: one, the world's. Not RT; move_probe() neither allocates nor blocks.
class ShapeWorld final : public World {
 public:
  // InvalidArgument: no shape, more than kMaxShapes, or one that PlacedShape does not find sound.
  [[nodiscard]] static Result<ShapeWorld> create(const std::vector<Shape>& shapes);

  [[nodiscard]] const WorldInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Result<ProbeId> add_probe(Position3 hand) override;
  void remove_probe(ProbeId probe) noexcept override;
  ProbeMotion move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept override;

 private:
  ShapeWorld();

  std::vector<PlacedShape> shapes_;
  WorldInfo info_;
  ProbeSlots<Position3> probes_;
};

}  // namespace thimble::world
