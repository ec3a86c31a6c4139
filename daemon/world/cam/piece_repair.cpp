#include "daemon/world/cam/piece_repair.hpp"

#include <optional>

namespace thimble::world::cam {
namespace {

using namespace cell;

struct Found {
  std::size_t origin{0};
  PieceSizes sizes{};
};

[[nodiscard]] Found find(const CamCells& cells) {
  Found found;
  for (const std::uint16_t bits : cells) {
    if ((bits & kOrigin) != 0) ++found.origin;
    ++found.sizes[static_cast<std::size_t>(part_of(bits))];
  }
  return found;
}

// Which piece is held, whether or not what was under way has been done.
[[nodiscard]] std::optional<int> held_in(const Found& found, const PieceState& state) noexcept {
  if (found.origin > 0) {
    const int held = state.held != 0 ? state.held : state.held_next.value_or(0);
    return held != 0 ? std::optional(held) : std::nullopt;
  }
  const bool may_be_none = state.held == 0 || state.held_next == 0;
  return may_be_none ? std::optional(0) : std::nullopt;
}

// What sizes must be found when that piece is held; nothing: they are others.
[[nodiscard]] bool agrees(const Found& found, int held, PieceState& state) noexcept {
  const bool has_let_go = held == 0 && state.held != 0;
  if (held != 0 && found.origin != state.sizes[static_cast<std::size_t>(held)]) return false;
  for (int part = 1; part <= kMostPieces; ++part) {
    const auto n = static_cast<std::size_t>(part);
    if (found.sizes[n] == (part == held ? 0 : state.sizes[n])) continue;
    // Of a drop it is a loss: half a scan, or no power in the middle of it.
    const bool is_deleted =
        has_let_go && state.is_deleting && part == state.held && found.sizes[n] == 0;
    if (!is_deleted) return false;
  }
  if (has_let_go) {
    const auto n = static_cast<std::size_t>(state.held);
    state.sizes[n] = found.sizes[n];
  }
  return true;
}

[[nodiscard]] CamAxes cell_at(const CamGeometry& space, std::size_t index) noexcept {
  CamAxes cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto bits = static_cast<unsigned>(space.log2_cells[axis]);
    cell[axis] = static_cast<int>(index & ((std::size_t{1} << bits) - 1));
    index >>= bits;
  }
  return cell;
}

// Pieces wrap around the edges of the space.
[[nodiscard]] std::size_t moved(const CamGeometry& space, std::size_t index,
                                const PieceState& state) noexcept {
  CamAxes cell = cell_at(space, index);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = (cell[axis] + state.grasp[axis] - state.held_from[axis]) &
                 ((1 << space.log2_cells[axis]) - 1);
  }
  return index_of(space, cell);
}

// Where the pieces rest, the held one where it did.
[[nodiscard]] PieceLayout resting(const CamCells& cells, int held) {
  PieceLayout layout(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int part = (cells[i] & kOrigin) != 0 ? held : part_of(cells[i]);
    layout[i] = static_cast<std::uint8_t>(part);
  }
  return layout;
}

}  // namespace

CamCells cells_of(const PieceLayout& layout, const PieceSettings& settings,
                  const PieceState& state) {
  CamCells cells(layout.size());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = of_part(layout[i]);
  cells[index_of(settings.space, state.grasp)] |= kMoving;
  return cells;
}

bool repair(CamCells& cells, PieceState& state, const PieceSettings& settings) {
  const Found found = find(cells);
  const auto held = held_in(found, state);
  if (!held || !agrees(found, *held, state)) return false;
  state.held = *held;
  state.held_next.reset();
  state.is_deleting = false;
  state.boxes = boxes_of(settings.space, resting(cells, *held));
  for (std::uint16_t& bits : cells) bits &= kPart | kOrigin;
  if (state.held != 0) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if ((cells[i] & kOrigin) != 0) cells[moved(settings.space, i, state)] |= kShape;
    }
  }
  cells[index_of(settings.space, state.grasp)] |= state.held != 0 ? kGrasp : kMoving;
  return true;
}

}  // namespace thimble::world::cam
