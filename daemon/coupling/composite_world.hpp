#pragma once

#include <cstdint>

#include "daemon/coupling/probe_in_world.hpp"
#include "daemon/coupling/world_coupling.hpp"
#include "daemon/world/occupancy_teller.hpp"

namespace thimble::coupling {

// The world half of our own scheme: a probe follows the hand as by GhostPointWorld, and the answer
// also tells of cells that the arm half does not know yet, or that have changed
// (world/occupancy_teller.hpp), and whether its ghost is where the arm's own was.
//
// Thread: the world's thread. Not RT; answer() neither allocates nor blocks.
// Ownership: `world` must outlive it, and have World::felt_cells(); the destructor closes.
// Sessions: as by GhostPointWorld. Errors: open() refuses a world without cells, Unsupported, and
// passes on what the world says; answer() as GhostPointWorld.
class CompositeWorld final : public WorldCoupling {
 public:
  // `most_versions`: of blocks that are told; then all are told anew.
  CompositeWorld(world::World& world, std::uint32_t first_session,
                 std::uint32_t most_versions = world::OccupancyTeller::kMostVersions) noexcept;

  [[nodiscard]] Result<void> open(const HandSample& first) override;
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override;
  void close() noexcept override { probe_.close(); }
  [[nodiscard]] std::uint64_t cells_epoch() const noexcept override { return epoch(); }

 private:
  // Of the cells: of this process and, in it, of what was loaded, and how often versions began
  // anew.
  [[nodiscard]] std::uint64_t epoch() const noexcept {
    return std::uint64_t{first_session_} << 32U | std::uint32_t{world_.loads() + rounds_};
  }

  world::World& world_;
  ProbeInWorld probe_;
  std::uint32_t first_session_;
  std::uint32_t next_session_;
  world::OccupancyTeller teller_;
  std::uint32_t rounds_{0};  // of its versions
  ConstraintSet last_{};
};

}  // namespace thimble::coupling
