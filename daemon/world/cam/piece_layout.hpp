#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "daemon/world/cam/piece_rules.hpp"
#include "hal/base/result.hpp"
#include "hal/device/cam_board.hpp"

namespace thimble::world::cam {

// Thesis 4.2.2: what a leap of four cells cannot pass without touching it.
inline constexpr int kLeastThickness_cells = 4;

[[nodiscard]] CamAxes cells_along(const CamGeometry& space) noexcept;
// In the order of CamCells; the cell must be within the space.
[[nodiscard]] std::size_t index_of(const CamGeometry& space, const CamAxes& cell) noexcept;

// Where pieces rest: of each cell the number of its piece, 1 to kMostPieces, or 0.
using PieceLayout = std::vector<std::uint8_t>;

// How many cells each piece has, by its number; [0] counts the others.
using PieceSizes = std::array<std::size_t, kMostPieces + 1>;
[[nodiscard]] PieceSizes sizes_of(const PieceLayout& layout) noexcept;

// Where each piece lies, by its number, around the edges of the space: the least box that has all
// of it. Of those that are not there nothing is said.
using PieceBoxes = std::array<CamBox, kMostPieces + 1>;
[[nodiscard]] PieceBoxes boxes_of(const CamGeometry& space, const PieceLayout& layout);
// So far away, around the edges.
[[nodiscard]] CamBox moved_by(const CamGeometry& space, CamBox box, const CamAxes& cells) noexcept;
// And all that it sweeps over on any way there along the axes.
[[nodiscard]] CamBox swept_by(const CamGeometry& space, CamBox box, const CamAxes& cells) noexcept;

// So many pieces, each of one or two boxes that are at least kLeastThickness_cells thick (or as
// thick as the space is), apart from each other and from the middle of the space. The same for the
// same seed on every machine.
// Errors: InvalidArgument for more than kMostPieces, or than the space has room for.
[[nodiscard]] Result<PieceLayout> random_layout(const CamGeometry& space, int pieces,
                                                std::uint64_t seed);

}  // namespace thimble::world::cam
