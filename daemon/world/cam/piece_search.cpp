#include "daemon/world/cam/piece_search.hpp"

#include <cstdlib>

namespace thimble::world::cam {

std::optional<PieceSearch::Shift> PieceSearch::next() noexcept {
  while (true) {
    if (!is_trying_ && !begin_attempt()) return std::nullopt;
    // From the farthest on, by halves.
    if (blocked_ - free_ > 1) {
      const bool is_first = free_ == 0 && at_ == 0;
      return shift_to(is_first ? blocked_ - 1 : (free_ + blocked_) / 2, true);
    }
    const int distance = free_;
    const bool has_to_return = at_ != distance;
    const Shift back = shift_to(distance, false);
    end_attempt();
    if (has_to_return) return back;
  }
}

CamAxes PieceSearch::touching() const noexcept {
  CamAxes touching{};
  for (std::size_t axis = 0; axis < touching.size(); ++axis) {
    if (actual_[axis] != desired_[axis]) touching[axis] = touching_[axis];
  }
  return touching;
}

void PieceSearch::take(int overlapping) noexcept {
  if (overlapping > 0) {
    blocked_ = at_;
    overlapping_ = overlapping;
  } else {
    free_ = at_;
  }
}

bool PieceSearch::begin_attempt() noexcept {
  const std::size_t first = axis_;
  for (std::size_t turn = 0; turn < desired_.size(); ++turn) {
    axis_ = (first + turn) % desired_.size();
    const int left = desired_[axis_] - actual_[axis_];
    // Where it was stuck it still is, unless it has moved along another axis since.
    if (left == 0 || stuck_[axis_] == actual_) continue;
    way_ = left < 0 ? -1 : 1;
    is_trying_ = true;
    at_ = 0;
    free_ = 0;
    blocked_ = 1 + (std::abs(left) >= leap_ ? leap_ : 1);
    return true;
  }
  return false;
}

PieceSearch::Shift PieceSearch::shift_to(int distance, bool is_looked_at) noexcept {
  Shift shift{{}, is_looked_at};
  shift.cells[axis_] = way_ * (distance - at_);
  at_ = distance;
  return shift;
}

void PieceSearch::end_attempt() noexcept {
  is_trying_ = false;
  actual_[axis_] += way_ * free_;
  if (free_ > 0) return;
  stuck_[axis_] = actual_;
  touching_[axis_] = overlapping_;
}

}  // namespace thimble::world::cam
