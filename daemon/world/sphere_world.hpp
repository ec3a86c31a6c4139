#pragma once

#include <array>
#include <optional>

#include "daemon/world/material_map.hpp"
#include "daemon/world/sphere_motion.hpp"
#include "daemon/world/world.hpp"

namespace thimble::world {

// "Hello, sphere" (thesis 3.2): a ball and a floor, without cells and without outer walls. Its
// faces are tangent planes, which lie any way.
//
// Thread: one, the world's. Not RT; move_probe() neither allocates nor blocks.
class SphereWorld final : public World {
 public:
  // InvalidArgument unless all is finite, the radius above zero, and the top of the ball above the
  // floor. `surface`: how both feel.
  [[nodiscard]] static Result<SphereWorld> create(const SphereScene& scene,
                                                  const Material& surface = {});

  [[nodiscard]] const WorldInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Result<ProbeId> add_probe(Position3 hand) override;
  void remove_probe(ProbeId probe) noexcept override;
  ProbeMotion move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept override;

 private:
  struct Probe {
    ProbeId id{};
    SphereGhost ghost{};
  };
  SphereWorld(const SphereScene& scene, const Material& surface);
  [[nodiscard]] std::optional<Probe>* find(ProbeId id) noexcept;

  SphereScene scene_;
  Material surface_;
  WorldInfo info_;
  std::array<std::optional<Probe>, kMaxProbes> probes_{};
  std::uint32_t last_id_{0};
};

}  // namespace thimble::world
