#pragma once

#include <cstdint>
#include <optional>

#include "daemon/coupling/messages.hpp"
#include "daemon/coupling/world_coupling.hpp"
#include "daemon/world/simple_constraints.hpp"
#include "daemon/world/voxel_grid.hpp"

namespace thimble::coupling {

// The world half of the simple constraint model (thesis 3.7.1, figure 3-8): a face that the hand
// itself went through holds until the hand comes back through it. To be shown and compared with:
// who goes round an obstacle or through it is held by a wall that is no longer in the way.
//
// Thread: the world's thread. Not RT; answer() neither allocates nor blocks.
// Ownership: `grid` must outlive it; it takes no probe of its world.
// Errors: open() refuses a hand that is not finite. Such a sample is answered with the last set,
//         its number included, as by GhostPointWorld. Sets have no ghost.
class SimpleConstraintWorld final : public WorldCoupling {
 public:
  // Sessions are numbered as by GhostPointWorld.
  SimpleConstraintWorld(const world::VoxelGrid& grid, std::uint32_t first_session) noexcept
      : grid_(grid), next_session_(first_session) {}

  [[nodiscard]] Result<void> open(const HandSample& first) override;
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override;
  void close() noexcept override { state_.reset(); }

 private:
  const world::VoxelGrid& grid_;
  std::optional<world::SimpleConstraints> state_{};
  std::uint32_t next_session_;
  ConstraintSet last_{};
};

}  // namespace thimble::coupling
