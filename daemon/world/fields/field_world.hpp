#pragma once

#include <string>

#include "daemon/world/fields/field_motion.hpp"
#include "daemon/world/probe_slots.hpp"
#include "daemon/world/world.hpp"

namespace thimble::world {

// A world that a signed distance field says: matter where it is below 0 (thesis 3.7.2). Its faces
// are tangent planes, which lie any way; beyond the field the world is free.
//
// Thread: one, the world's. Not RT; move_probe() neither allocates nor blocks.
class FieldWorld final : public World {
 public:
  // `source` names it in messages. `surface`: how all of it feels.
  FieldWorld(DistanceField field, std::string source, const Material& surface = {});

  [[nodiscard]] const WorldInfo& info() const noexcept override { return info_; }
  [[nodiscard]] const DistanceField& field() const noexcept { return field_; }
  [[nodiscard]] Result<ProbeId> add_probe(Position3 hand) override;
  void remove_probe(ProbeId probe) noexcept override { probes_.remove(probe); }
  ProbeMotion move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept override;

 private:
  DistanceField field_;
  Material surface_;
  WorldInfo info_;
  ProbeSlots<Position3> probes_;
};

}  // namespace thimble::world
