#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/device/cam_board.hpp"
#include "sim/model/cam/engine/plane_engine.hpp"

namespace thimble::session {

// A program of a CAM that marks the zone around matter (thesis 3.6: "forcing the addition of the
// buffer zones"), in a space of its own beside that of the rule.
//
// A mark is layer 0 with copies in 1 and 2. A pass kicks the copies by +s and −s cells along one
// axis, and the table sets all three where any of them is. A zone of r cells along an axis is one
// of r + s cells afterwards, without gaps for s <= 2·r + 1: 1, 4, 13, 40 cells in as many passes;
// then the next axis, so that diagonals belong to it. On a torus it goes round the end of the
// space.
//
// Thread: one at a time. Not RT: 12 passes and the marks of all cells, some 2 ms for 2^18 cells.
class ZoneMarker {
 public:
  // Errors: InvalidArgument for a space that cannot be.
  [[nodiscard]] static Result<std::unique_ptr<ZoneMarker>> make(const CamAxes& log2_cells);
  // Sets the bits of cells that have matter within `cells` along each axis, clears the others. A
  // bit for each cell, as VoxelGrid::words() has them.
  void mark(std::span<const std::uint64_t> matter, std::int32_t cells,
            std::span<std::uint64_t> zone);

 private:
  explicit ZoneMarker(std::unique_ptr<sim::cam::PlaneEngine> engine);

  std::unique_ptr<sim::cam::PlaneEngine> engine_;
  std::vector<std::uint16_t> sites_;  // room
};

}  // namespace thimble::session
