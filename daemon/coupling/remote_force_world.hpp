#pragma once

#include <cstdint>

#include "daemon/coupling/probe_in_world.hpp"
#include "daemon/coupling/world_coupling.hpp"

namespace thimble::coupling {

// The world half of the remote closed loop (thesis 3.2): a probe follows the hand, and the force of
// what holds it back is the answer: wall_penalty() at the position that the sample says, with the
// arm's own stiffness and damping (HandSample::tool) where the world names none, up to
// kHardestTool. SOURCE: as of RemoteForceArm.
//
// Thread: the world's thread. Not RT; answer() neither allocates nor blocks.
// Ownership: `world` must outlive it; the destructor closes. Sessions: as by GhostPointWorld.
// Errors: open() passes on what the world says. A sample that is not finite or was overtaken, or of
//         which the world cannot say anything, is answered with the last set, its number included.
class RemoteForceWorld final : public WorldCoupling {
 public:
  RemoteForceWorld(world::World& world, std::uint32_t first_session) noexcept
      : probe_(world), next_session_(first_session) {}

  [[nodiscard]] Result<void> open(const HandSample& first) override;
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override;
  void close() noexcept override { probe_.close(); }

 private:
  ProbeInWorld probe_;
  std::uint32_t next_session_;
  ConstraintSet last_{};
};

}  // namespace thimble::coupling
