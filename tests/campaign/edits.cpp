#include "tests/campaign/edits.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tests/campaign/dice.hpp"

namespace thimble::campaign {
namespace {

using Kind = world::CellEdit::Kind;

world::Cell last_cell(const world::VoxelWorld& world) {
  world::Cell last;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    last[axis] = static_cast<std::int32_t>(world.info().cells[axis]) - 1;
  }
  return last;
}

Kind kind_of(EventKind kind) noexcept {
  if (kind == EventKind::EditBox) return Kind::Box;
  return kind == EventKind::EditPaint ? Kind::Paint : Kind::Fill;
}

// Where the middle of an edit is along an axis: at the finger, or anywhere.
std::int32_t middle_of(const world::VoxelWorld& world, std::size_t axis, double hand_m,
                       bool is_near, Dice& dice) {
  const auto cells = static_cast<std::int32_t>(world.info().cells[axis]);
  if (!is_near) return static_cast<std::int32_t>(dice.below(static_cast<std::uint64_t>(cells)));
  const double cell = std::floor(hand_m / world.info().cell_m + cells / 2.0);
  return static_cast<std::int32_t>(std::clamp(cell, 0.0, cells - 1.0));
}

}  // namespace

std::size_t all_cells(const world::World& world) noexcept {
  const auto& cells = world.info().cells;
  return std::size_t{cells[0]} * cells[1] * cells[2];
}

world::CellEdit edit_of(const Event& event, const world::VoxelWorld& world, Position3 hand) {
  Dice dice(event.cell);
  const world::Cell end = last_cell(world);
  world::CellEdit edit;
  edit.kind = kind_of(event.kind);
  edit.value = static_cast<std::uint8_t>(1 + dice.below(world.materials() + 1));
  if (event.kind == EventKind::EditAll) edit.value = 1;
  if (event.kind == EventKind::EditClear) edit.value = 0;
  const bool is_whole = event.kind == EventKind::EditAll || dice.chance(0.05);
  const bool is_near = dice.chance(0.67);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t middle = middle_of(world, axis, hand[axis], is_near, dice);
    const auto reach = [&dice] { return static_cast<std::int32_t>(dice.below(3)); };
    edit.first[axis] = is_whole ? 0 : std::max(0, middle - reach());
    edit.last[axis] = is_whole ? end[axis] : std::min(end[axis], middle + reach());
    edit.center[axis] = is_near ? hand[axis] + dice.uniform(-1, 1) * world.info().cell_m
                                : dice.uniform(-0.5, 0.5) * world.info().extent_m[axis];
  }
  edit.radius_m = dice.uniform(0.3, 3) * world.info().cell_m;
  return edit;
}

void Edits::begin(const Event& event, Position3 hand) {
  if (host_->edits() == nullptr) return;
  const world::CellEdit edit = edit_of(event, *host_->world().editable(), hand);
  lasting_.emplace_back(&event, edit);
  submit({edit});
}

void Edits::end(const Event& event) {
  const auto found = std::find_if(lasting_.begin(), lasting_.end(),
                                  [&event](const auto& one) { return one.first == &event; });
  if (found == lasting_.end()) return;
  world::CellEdit clear = found->second;
  lasting_.erase(found);
  clear.value = 0;
  world::CellEdit walls;
  walls.kind = Kind::Box;
  walls.last = last_cell(*host_->world().editable());
  submit({clear, walls});
}

void Edits::submit(std::vector<world::CellEdit> edits) {
  const auto submitted = host_->submit_edits(std::move(edits));
  if (submitted || submitted.error().code == Errc::Busy) return;
  throw std::logic_error("a good edit was refused: " + submitted.error().message);
}

std::uint64_t Edits::waiting() const noexcept {
  return host_->edits() == nullptr ? 0 : host_->edits()->waiting();
}

std::uint64_t Edits::applied() const noexcept {
  return host_->edits() == nullptr ? 0 : host_->edits()->applied();
}

bool Edits::has_applied() noexcept {
  const std::uint64_t before = std::exchange(applied_, applied());
  return applied_ != before;
}

}  // namespace thimble::campaign
