#include "daemon/coupling/composite_world.hpp"

#include "daemon/coupling/tell.hpp"

namespace thimble::coupling {

CompositeWorld::CompositeWorld(world::World& world, std::uint32_t first_session,
                               std::uint32_t most_versions) noexcept
    : world_(world),
      probe_(world),
      first_session_(first_session),
      next_session_(first_session),
      teller_(most_versions) {}

Result<void> CompositeWorld::open(const HandSample& first) {
  if (world_.felt_cells() == nullptr) {
    return fail(Errc::Unsupported, world_.info().source + ": a map is made of cells");
  }
  if (Result<void> opened = probe_.open(first); !opened) return opened;
  teller_.reset();
  last_ = {};
  last_.session = next_session_++;
  last_.map.epoch = epoch();
  return {};
}

ConstraintSet CompositeWorld::answer(const HandSample& sample, Duration dt) noexcept {
  if (!probe_.is_open() || sample.sequence <= last_.answers) return last_;
  const auto moved = follow_and_tell(probe_, sample, dt, last_);
  if (!moved) return last_;
  const world::ProbeMotion& motion = *moved;
  if (teller_.is_used_up()) ++rounds_;
  const std::uint64_t cells = epoch();
  if (cells != last_.map.epoch) teller_.forget();
  // One that came through other cells is where it is for no fault of its own.
  const bool is_of_these = sample.epoch == 0 || sample.epoch == cells;
  last_.is_astray = sample.has_ghost && is_of_these && sample.ghost != motion.ghost;
  teller_.acknowledge(sample.applied_reply, sample.applied_before);
  const world::VoxelGrid& grid = *world_.felt_cells();
  last_.map = {.epoch = cells,
               .lattice = grid.lattice(),
               .ghost_cell = motion.cell,
               .is_plane = world_.is_plane(),
               .blocks = teller_.tell(grid, motion.cell, last_.sequence)};
  last_.has_map = true;
  return last_;
}

}  // namespace thimble::coupling
