#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "daemon/world/cell.hpp"
#include "hal/base/result.hpp"
#include "hal/base/units.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// How matter feels; negative: as the arm is configured.
struct Material {
  Stiffness stiffness{-1};
  Damping damping{-1};
  double friction{-1};            // Coulomb's coefficient
  double temperature_kelvin{-1};  // negative: not known
  bool operator==(const Material&) const = default;
};

// Which material each cell of a grid is of: 1, 2 or 4 bits a cell for up to 1, 3 or 15 materials,
// so at most 512 MiB for 1024^3 cells, and nothing at all where no materials were named.
//
// Thread: one at a time. RT: reading and set() are THIMBLE_RT; create() allocates.
class MaterialMap {
 public:
  static constexpr std::size_t kMaxMaterials = 15;

  // Every cell is of `all`.
  explicit MaterialMap(Material all = {}) : materials_{all} {}
  // Label n from 1 up is materials[n - 1]; every cell begins with label 0, the arm's own surface.
  // `cells` as of a VoxelGrid. TooLarge for more than kMaxMaterials; none takes no memory.
  [[nodiscard]] static Result<MaterialMap> create(std::array<std::uint32_t, 3> cells,
                                                  const std::vector<Material>& materials);

  // Outside the grid: label 0.
  [[nodiscard]] THIMBLE_RT const Material& at(Cell cell) const noexcept {
    return materials_[label(cell)];
  }
  // A cell outside the grid and a label that does not exist are left alone.
  THIMBLE_RT void set(Cell cell, std::uint8_t label) noexcept;
  // The cells of one row from `from` up to, not including, x = `end_x`, cut to the grid; as set().
  THIMBLE_RT void set_row(Cell from, std::int32_t end_x, std::uint8_t label) noexcept;
  // Labels above 0.
  [[nodiscard]] std::size_t count() const noexcept { return materials_.size() - 1; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return words_.size() * 8; }

 private:
  [[nodiscard]] bool is_inside(Cell cell) const noexcept;
  [[nodiscard]] std::size_t index_of(Cell cell) const noexcept;
  [[nodiscard]] std::size_t label(Cell cell) const noexcept;

  std::array<std::uint32_t, 3> cells_{};
  unsigned bits_{0};  // a cell
  std::vector<Material> materials_;
  std::vector<std::uint64_t> words_{};
};

}  // namespace thimble::world
