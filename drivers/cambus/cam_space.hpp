#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/cambus/register_words.hpp"
#include "hal/base/result.hpp"
#include "hal/device/cam_board.hpp"

namespace thimble::cambus {

using Axes = CamAxes;
using Division = CamDivision;
using LayerKick = CamKick;

// How the modules of a board are wired: a torus of 1, 2 or 4 along each axis. Module n is the n-th
// of a way through all of them that always goes to a neighbour; for a box of eight it is the order
// of MIT's software.
struct BoardShape {
  Axes log2_modules{0, 0, 0};
  int log2_sites{22};  // of a module: 22 or 24

  [[nodiscard]] int modules() const noexcept {
    return 1 << (log2_modules[0] + log2_modules[1] + log2_modules[2]);
  }
};

// Where a module stands in the torus.
[[nodiscard]] Axes position_of(const BoardShape& board, int module) noexcept;

// The glue pin, in the order of field::kConnect, that leads a module to the next one of the way.
[[nodiscard]] std::size_t pin_to_next(const BoardShape& board, int module) noexcept;

// A cell: which module has it, and at which site address.
struct CellPlace {
  int module{0};
  std::uint32_t site{0};
  bool operator==(const CellPlace&) const = default;
};

// Sites that a scan visits, the same of every module: its own cells from `first` on, by axis. Each
// axis begins at a multiple of its length, for what the permuter can say is that some bits of the
// address are constants (docs/cambus.md, register 15).
struct ScanBlock {
  Axes first{};
  Axes log2_cells{};
  bool operator==(const ScanBlock&) const = default;
};

// A slice of a space as a monitor has it: rows one after the other, those of a module together.
struct CamRaster {
  ScanBlock line;            // the first row of a module
  ScanBlock sector;          // all rows of a module
  std::vector<int> modules;  // in their order
};

// A space of cells on a board: sizes are powers of two, each axis wraps. Gives the registers that
// lay it out (docs/cambus.md, sections 1 and 2). Pure.
class CamSpace {
 public:
  // Errors: InvalidArgument when the cells do not fit, or an axis that is divided leaves less than
  // two cells for a module.
  [[nodiscard]] static Result<CamSpace> make(const BoardShape& board, const Axes& log2_cells,
                                             Division division);

  [[nodiscard]] const BoardShape& board() const noexcept { return board_; }
  [[nodiscard]] int modules() const noexcept { return board_.modules(); }
  // Of a module, by axis and in all.
  [[nodiscard]] const Axes& log2_sector() const noexcept { return sector_; }
  [[nodiscard]] int log2_sector_sites() const noexcept {
    return sector_[0] + sector_[1] + sector_[2];
  }
  [[nodiscard]] CellPlace place_of(const Axes& cell) const noexcept;

  // All sites of a module that the space has.
  [[nodiscard]] ScanBlock whole() const noexcept { return {{}, sector_}; }
  // Blocks apart from each other that have all cells of a box, wherever modules meet; those whose
  // scans take the fewest clocks, with what has to be said for each and how long a byte of that
  // takes to the board. Where nothing is saved, the whole.
  // Errors: InvalidArgument for a box that begins outside of the space, or has no cells or more
  // than that along an axis.
  [[nodiscard]] Result<std::vector<ScanBlock>> blocks_around(const CamBox& box,
                                                             std::uint64_t clocks_a_byte = 0) const;
  // Of a scan of it, sweeps and refreshes included.
  [[nodiscard]] std::uint64_t clocks_of(const ScanBlock& block) const noexcept;

  // Errors: InvalidArgument, there is no such slice, or rows are divided among modules; TooLarge,
  // more or longer rows than a monitor has lines.
  [[nodiscard]] Result<CamRaster> raster(int slice) const;

  [[nodiscard]] RegisterWords dimension() const;
  // `block` must be one of a module's.
  [[nodiscard]] RegisterWords scan_format(const ScanBlock& block) const;
  [[nodiscard]] RegisterWords scan_perm(const ScanBlock& block) const;
  [[nodiscard]] RegisterWords connect(int module) const;
  // Layers that are not named stand still; of a layer named twice the last counts.
  // Errors: InvalidArgument when a kick is longer than a module is, on an axis that is divided.
  [[nodiscard]] Result<RegisterWords> kick(std::span<const LayerKick> kicks) const;

 private:
  CamSpace() = default;
  [[nodiscard]] bool is_divided(std::size_t axis) const noexcept { return log2_parts_[axis] > 0; }
  [[nodiscard]] int first_bit(std::size_t axis) const noexcept;
  [[nodiscard]] RegisterWords strip_connect(int module, std::size_t axis) const;
  [[nodiscard]] int log2_sweep(const ScanBlock& block) const noexcept;

  BoardShape board_;
  Division division_{Division::Mesh};
  Axes sector_{};
  Axes log2_parts_{};  // modules along each axis of the space
};

}  // namespace thimble::cambus
