#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "daemon/world/cam/piece_layout.hpp"
#include "daemon/world/cam/piece_state.hpp"
#include "daemon/world/cam/piece_zone.hpp"
#include "tests/unit/world/cam/greedy_walk.hpp"

namespace thimble::world::cam::test {

// Pieces as numbers in one array whose axes wrap, and a shape as a list of cells: no tables, no
// layers, no board. Pieces must be thick enough for the search.
class PieceOracle {
 public:
  PieceOracle(const CamGeometry& space, const PieceLayout& layout, const CamAxes& grasp)
      : space_(space), cells_(cells_along(space)), first_(layout), first_grasp_(grasp) {
    reset();
  }

  void move(const CamAxes& desired) {
    if (is_free_ || is_embedded_) {
      grasp_ = sum(grasp_, desired);
      is_embedded_ = overlaps({});
      touching_ = {};
      return;
    }
    const CamAxes by =
        greedy_walk(desired, [this](const CamAxes& moved) { return overlaps(moved); });
    grasp_ = sum(grasp_, by);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CamAxes next{};
      next[axis] = desired[axis] < by[axis] ? -1 : desired[axis] > by[axis] ? 1 : 0;
      touching_[axis] = next == CamAxes{} ? 0 : overlapping(next);
    }
  }

  PieceOutcome act(PieceAction action, const CamAxes& pressed) {
    switch (action) {
      case PieceAction::Select:
        return select(pressed);
      case PieceAction::Drop:
      case PieceAction::Delete:
        return let_go(action == PieceAction::Delete);
      case PieceAction::ToggleFree:
        is_free_ = !is_free_;
        is_embedded_ = overlaps({});
        return is_free_ ? PieceOutcome::FreeMotionOn : PieceOutcome::FreeMotionOff;
      case PieceAction::Reset:
        reset();
        return PieceOutcome::WasReset;
      case PieceAction::Look:
        return PieceOutcome::Looked;
    }
    return PieceOutcome::BoardFailed;
  }

  // What a board must hold: shape, grasp point and resting pieces.
  [[nodiscard]] CamCells cells() const {
    CamCells cells(parts_.size());
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = cell::of_part(parts_[i]);
    for (const CamAxes& part : shape_) cells[wrapped(sum(grasp_, part))] |= cell::kShape;
    cells[wrapped(grasp_)] |= cell::kGrasp;
    return cells;
  }
  // What somebody who looks must see: a held piece where it is held, on top.
  [[nodiscard]] PieceLayout picture() const {
    PieceLayout picture = parts_;
    if (held_ == 0) return picture;
    for (const CamAxes& part : shape_) {
      picture[wrapped(sum(grasp_, part))] = static_cast<std::uint8_t>(held_);
    }
    return picture;
  }
  [[nodiscard]] const CamAxes& grasp() const noexcept { return grasp_; }
  // Cells that would overlap one cell further along each axis on which the last move was stopped.
  [[nodiscard]] const CamAxes& touching() const noexcept { return touching_; }
  // What a look around that goes so many cells far must find; each cell is tried.
  [[nodiscard]] PieceZone zone(int cells) const {
    PieceZone zone{grasp_, cells, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int sign : {-1, 1}) {
        const int edge = sign < 0 ? grasp_[axis] : cells_[axis] - 1 - grasp_[axis];
        PieceZone::Way& way = zone.ways[axis][sign < 0 ? 0 : 1];
        for (int n = 1; n <= std::min(cells, edge) && way.touching == 0; ++n) {
          CamAxes there{};
          there[axis] = sign * n;
          way.touching = overlapping(there);
          if (way.touching == 0) way.free = n;
        }
      }
    }
    return zone;
  }
  [[nodiscard]] int held() const noexcept { return held_; }
  [[nodiscard]] bool is_embedded() const noexcept { return is_embedded_; }
  [[nodiscard]] bool is_free() const noexcept { return is_free_; }

 private:
  static CamAxes sum(const CamAxes& a, const CamAxes& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
  }
  [[nodiscard]] std::size_t wrapped(CamAxes cell) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] = ((cell[axis] % cells_[axis]) + cells_[axis]) % cells_[axis];
    }
    return index_of(space_, cell);
  }
  [[nodiscard]] int overlapping(const CamAxes& way) const {
    const auto cells = std::count_if(shape_.begin(), shape_.end(), [&](const CamAxes& part) {
      return parts_[wrapped(sum(sum(grasp_, way), part))] != 0;
    });
    return static_cast<int>(cells);
  }
  [[nodiscard]] bool overlaps(const CamAxes& way) const { return overlapping(way) != 0; }
  PieceOutcome select(const CamAxes& pressed) {
    if (held_ != 0) return PieceOutcome::AlreadyHeld;
    std::vector<CamAxes> places{{}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CamAxes place{};
      place[axis] = pressed[axis];
      if (pressed[axis] != 0) places.push_back(place);
    }
    for (const CamAxes& place : places) {
      const int part = parts_[wrapped(sum(grasp_, place))];
      if (part == 0) continue;
      grasp_ = sum(grasp_, place);
      take_up(part);
      return PieceOutcome::Selected;
    }
    return PieceOutcome::NothingThere;
  }
  void take_up(int part) {
    held_ = part;
    is_embedded_ = false;
    shape_.clear();
    CamAxes at{};
    for (at[2] = 0; at[2] < cells_[2]; ++at[2]) {
      for (at[1] = 0; at[1] < cells_[1]; ++at[1]) {
        for (at[0] = 0; at[0] < cells_[0]; ++at[0]) {
          auto& there = parts_[index_of(space_, at)];
          if (there != part) continue;
          there = 0;
          shape_.push_back({at[0] - grasp_[0], at[1] - grasp_[1], at[2] - grasp_[2]});
        }
      }
    }
  }
  PieceOutcome let_go(bool is_deleted) {
    if (held_ == 0) return PieceOutcome::NothingHeld;
    if (!is_deleted && overlaps({})) return PieceOutcome::NoRoom;
    for (const CamAxes& part : shape_) {
      if (!is_deleted) parts_[wrapped(sum(grasp_, part))] = static_cast<std::uint8_t>(held_);
    }
    held_ = 0;
    shape_ = {{}};
    is_embedded_ = overlaps({});
    return is_deleted ? PieceOutcome::Deleted : PieceOutcome::Dropped;
  }
  void reset() {
    parts_ = first_;
    grasp_ = first_grasp_;
    shape_ = {{}};
    held_ = 0;
    is_free_ = false;
    is_embedded_ = overlaps({});
    touching_ = {};
  }

  CamGeometry space_;
  CamAxes cells_;
  PieceLayout first_;
  CamAxes first_grasp_;
  PieceLayout parts_;
  CamAxes grasp_{};
  std::vector<CamAxes> shape_;  // from the grasp point
  int held_{0};
  bool is_free_{false};
  CamAxes touching_{};
  bool is_embedded_{false};
};

}  // namespace thimble::world::cam::test
