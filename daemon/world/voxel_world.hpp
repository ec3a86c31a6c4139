#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "daemon/world/free_rows.hpp"
#include "daemon/world/ghost_motion.hpp"
#include "daemon/world/material_map.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "daemon/world/world.hpp"

namespace thimble::world {

// A world of cubic cells, free or occupied, that may change at any time.
//
// Thread: one, the world's. Not RT; move_probe() and set_cell() neither allocate nor block.
// Ownership: owns its grid.
class VoxelWorld final : public World {
 public:
  // Cells of the grid that are occupied feel as `materials` says.
  VoxelWorld(VoxelGrid grid, std::string source, MaterialMap materials = MaterialMap());

  [[nodiscard]] const WorldInfo& info() const noexcept override { return info_; }
  [[nodiscard]] const VoxelGrid* grid() const noexcept override { return &grid_; }
  [[nodiscard]] VoxelWorld* editable() noexcept override { return this; }
  [[nodiscard]] Result<ProbeId> add_probe(Position3 hand) override;
  void remove_probe(ProbeId probe) noexcept override;
  ProbeMotion move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept override;

  // A cell outside the grid is left alone; it stays occupied. A cell that is filled anew has no
  // material of its own.
  void set_cell(Cell cell, bool is_occupied) noexcept {
    if (is_occupied && !grid_.is_occupied(cell)) materials_.set(cell, 0);
    const std::size_t changed = grid_.set_row(cell, cell.x + 1, is_occupied);
    if (changed > 0) note_changed(cell);
    occupied_ = is_occupied ? occupied_ + changed : occupied_ - changed;
  }
  // The cells of one row from `from` up to, not including, x = `end_x`: 0 frees them, 1 fills them
  // with what has no material, 1 + n with the n-th material; also those that were filled. Returns
  // how many were freed or filled.
  std::size_t set_row(Cell from, std::int32_t end_x, std::uint8_t value) noexcept;
  // All cells at once, as VoxelGrid::words() has them and as many of them; nothing else happens to
  // cells that stay as they are. Those that are filled anew have no material.
  void assign(std::span<const std::uint64_t> occupied) noexcept;
  [[nodiscard]] std::size_t materials() const noexcept { return materials_.count(); }
  [[nodiscard]] std::size_t occupied_cells() const noexcept override { return occupied_; }
  [[nodiscard]] bool is_occupied(Cell cell) const noexcept { return grid_.is_occupied(cell); }
  // Grows whenever a cell is freed or filled.
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }
  // What looking for places to start has cost: FreeRows::looked_at().
  [[nodiscard]] std::uint64_t looked_at() const noexcept { return free_rows_.looked_at(); }

 private:
  struct Probe {
    ProbeId id{};
    GhostState ghost{};
  };
  [[nodiscard]] std::optional<Probe>* find(ProbeId id) noexcept;

  void note_changed(Cell row) noexcept {
    ++changes_;
    free_rows_.note_changed(grid_, row);
  }
  void assign_word(std::size_t index, std::uint64_t changed) noexcept;
  void paint(const GhostPoint& ghost, ProbeMotion& motion) const noexcept;

  VoxelGrid grid_;
  MaterialMap materials_;
  FreeRows free_rows_;
  std::size_t occupied_;
  std::uint64_t changes_{0};
  WorldInfo info_;
  std::array<std::optional<Probe>, kMaxProbes> probes_{};
  std::uint32_t last_id_{0};
};

}  // namespace thimble::world
