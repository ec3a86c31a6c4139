#pragma once

#include <string>

#include "daemon/world/cam/piece_layout.hpp"
#include "hal/base/result.hpp"
#include "hal/device/cam_board.hpp"

namespace thimble::session {

// A space and where pieces rest in it.
struct PieceFile {
  CamAxes log2_cells{};
  world::cam::PieceLayout layout{};
};

// Ours: as many cells as a plane of 512 x 512.
inline constexpr int kMostLog2PieceCells = 18;
inline constexpr int kLeastLog2PieceCells = 10;

// Reads a volume file of three axes (.npy, .nrrd or .nhdr): each number is that of its cell's
// piece, 1 to kMostPieces, or 0 and less for none. Along each axis there is a power of two of them.
// Any thread; not RT. Errors: one sentence that begins with the path.
[[nodiscard]] Result<PieceFile> read_piece_file(const std::string& path);

}  // namespace thimble::session
