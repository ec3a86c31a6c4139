#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/device/cam_board.hpp"

namespace thimble::world::cam {

// All that a running automaton is: put back, it goes on as it would have.
struct AutomatonState {
  std::string rule;  // "life" …
  CamAxes log2_cells{};
  std::uint64_t steps{0};            // taken so far
  std::vector<std::uint16_t> sites;  // one a cell; x runs fastest, then y
  bool operator==(const AutomatonState&) const = default;
};

// A space of cells that changes by a rule, step by step, on whatever computes it: some of them are
// matter that a hand can feel.
//
// Thread: one at a time. Not RT; each call is bounded by the number of cells. Cells are numbered as
// VoxelGrid::words() has them, and spans have a bit for each.
class Automaton {
 public:
  virtual ~Automaton() = default;
  [[nodiscard]] virtual CamAxes log2_cells() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t steps() const noexcept = 0;
  virtual void step() = 0;
  // Which cells are matter.
  virtual void read(std::span<std::uint64_t> matter) = 0;
  // Cells whose bit is set in `changed` become what `matter` says; no other cell changes.
  virtual void write(std::span<const std::uint64_t> changed,
                     std::span<const std::uint64_t> matter) = 0;
  // Sets the bits of the cells that have matter within `cells` of them along each axis, diagonals
  // included, and perhaps of more; clears the others. False: it cannot.
  [[nodiscard]] virtual bool mark_zone(std::int32_t cells, std::span<std::uint64_t> zone) = 0;
  [[nodiscard]] virtual AutomatonState save() = 0;
  // Errors: InvalidArgument for the state of another rule or space; nothing is changed then.
  [[nodiscard]] virtual Result<void> load(const AutomatonState& state) = 0;
};

}  // namespace thimble::world::cam
