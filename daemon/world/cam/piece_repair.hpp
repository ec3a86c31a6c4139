#pragma once

#include "daemon/world/cam/piece_layout.hpp"
#include "daemon/world/cam/piece_state.hpp"

namespace thimble::world::cam {

// Cells in which pieces rest and nothing is held; the shape is the grasp point.
[[nodiscard]] CamCells cells_of(const PieceLayout& layout, const PieceSettings& settings,
                                const PieceState& state);

// After a board failed: makes cells and state one again. `cells` is what it holds; which piece is
// held, and where the others rest, is read from planes that nothing ever moves, and the moving
// planes are written anew where the board had confirmed them to be. Pure.
// False, and nothing is changed: the pieces are not all there; a board lost its memory, or scanned
// half of it.
[[nodiscard]] bool repair(CamCells& cells, PieceState& state, const PieceSettings& settings);

}  // namespace thimble::world::cam
