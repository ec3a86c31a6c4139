#include "daemon/world/edit_queue.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

namespace thimble::world {
namespace {

constexpr const char* kAxes = "xyz";

// `at` cut to an index from `low` to `high`; what is no number is `low`.
[[nodiscard]] std::int32_t index_of(double at, std::int32_t low, std::int32_t high) noexcept {
  if (!(at > low)) return low;
  return at < high ? static_cast<std::int32_t>(at) : high;
}

// The cells along one axis whose centres lie within `half_m` of `at_m`, as far as there are any:
// none where the first is above the last.
[[nodiscard]] std::pair<std::int32_t, std::int32_t> cells_within(const VoxelGrid& grid,
                                                                 std::size_t axis, double at_m,
                                                                 double half_m) noexcept {
  const auto count = static_cast<std::int32_t>(grid.cells()[axis]);
  const double middle = at_m / grid.cell_m() + (count - 1) / 2.0;
  const double half = half_m / grid.cell_m();
  return {index_of(std::ceil(middle - half), 0, count),
          index_of(std::floor(middle + half), -1, count - 1)};
}

// What an edit reaches, ends included.
[[nodiscard]] std::pair<Cell, Cell> bounds_of(const VoxelGrid& grid,
                                              const CellEdit& edit) noexcept {
  if (edit.kind != CellEdit::Kind::Paint) return {edit.first, edit.last};
  std::pair<Cell, Cell> bounds;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::tie(bounds.first[axis], bounds.second[axis]) =
        cells_within(grid, axis, edit.center[axis], edit.radius_m);
  }
  return bounds;
}

[[nodiscard]] bool is_empty(const std::pair<Cell, Cell>& bounds) noexcept {
  const auto& [first, last] = bounds;
  return first.x > last.x || first.y > last.y || first.z > last.z;
}

// At most so many rows of up to 64 cells, as a slice counts them.
[[nodiscard]] std::size_t words_of(const VoxelGrid& grid, const CellEdit& edit) noexcept {
  const auto bounds = bounds_of(grid, edit);
  if (is_empty(bounds)) return 1;
  const auto length = [&](std::size_t axis) {
    return static_cast<std::size_t>(bounds.second[axis] - bounds.first[axis]) + 1;
  };
  return (1 + (length(0) - 1) / 64) * length(1) * length(2);
}

[[nodiscard]] bool is_brush(const CellEdit& edit) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(std::abs(edit.center[axis]) <= kMaxBrush_m)) return false;
  }
  return edit.radius_m > 0 && edit.radius_m <= kMaxBrush_m;
}

[[nodiscard]] double center_of_m(const VoxelGrid& grid, std::size_t axis, std::int32_t i) noexcept {
  return (grid.face_m(axis, i) + grid.face_m(axis, i + 1)) / 2;
}

}  // namespace

Result<void> check_edit(const VoxelWorld& world, const CellEdit& edit) {
  if (edit.value > 1 + world.materials()) {
    return fail(Errc::InvalidArgument,
                "cell: " + std::to_string(edit.value) + " is not within 0 to " +
                    std::to_string(1 + world.materials()) +
                    ": 0 is free, 1 filled, and 1 + n of the world's n-th material");
  }
  if (edit.kind == CellEdit::Kind::Paint) {
    if (is_brush(edit)) return {};
    return fail(Errc::InvalidArgument,
                "center_m, radius_m: expected a centre within 1e6 m of the origin along each axis, "
                "and a radius above 0 and up to 1e6 m");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto end = static_cast<std::int32_t>(world.info().cells[axis]);
    if (edit.first[axis] >= 0 && edit.first[axis] <= edit.last[axis] && edit.last[axis] < end) {
      continue;
    }
    return fail(Errc::InvalidArgument,
                std::string("min, max: along ") + kAxes[axis] +
                    " expected 0 <= min <= max <= " + std::to_string(end - 1) + ", found " +
                    std::to_string(edit.first[axis]) + " and " + std::to_string(edit.last[axis]));
  }
  return {};
}

Result<std::uint64_t> EditQueue::submit(std::vector<CellEdit> edits) {
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const Result<void> good = check_edit(*world_, edits[i]);
    if (good) continue;
    if (edits.size() == 1) return tl::unexpected(good.error());
    return tl::unexpected(good.error().in("edit " + std::to_string(i)));
  }
  std::size_t words = 0;
  for (const CellEdit& edit : edits) words += words_of(*world_->grid(), edit);
  if (words > kMaxWaitingWords) {
    return fail(Errc::TooLarge, "these edits would take seconds; ask for them in several requests");
  }
  if (batches_.size() >= kMaxBatches || waiting_words_ + words > kMaxWaitingWords) {
    return fail(Errc::Busy, "too many edits wait for their turn already; ask again later");
  }
  waiting_ += edits.size();
  waiting_words_ += words;
  Batch batch;
  batch.words = words;
  batch.number = ++last_number_;
  batch.edits = std::move(edits);
  batches_.push_back(std::move(batch));
  return last_number_;
}

void EditQueue::step() {
  std::size_t words_left = kSliceWords;
  while (!batches_.empty()) {
    Batch& batch = batches_.front();
    while (batch.next < batch.edits.size()) {
      if (!advance(batch, batch.edits[batch.next], words_left)) return;
      ++batch.next;
      batch.is_begun = false;
      ++applied_;
      --waiting_;
    }
    finished_.push_back({batch.number, batch.changed_cells});
    waiting_words_ -= batch.words;
    batches_.pop_front();
  }
}

void EditQueue::withdraw(std::uint64_t batch) {
  const auto found = std::find_if(batches_.begin(), batches_.end(),
                                  [&](const Batch& one) { return one.number == batch; });
  if (found == batches_.end() || found->next > 0 || found->is_begun) return;
  waiting_ -= found->edits.size();
  waiting_words_ -= found->words;
  batches_.erase(found);
}

std::vector<EditQueue::Finished> EditQueue::take_finished() { return std::exchange(finished_, {}); }

bool EditQueue::advance(Batch& batch, const CellEdit& edit, std::size_t& words_left) noexcept {
  const auto bounds = bounds_of(*world_->grid(), edit);
  if (is_empty(bounds)) return true;
  const auto& [first, last] = bounds;
  if (!std::exchange(batch.is_begun, true)) batch.row = {0, first.y, first.z};
  for (; batch.row.z <= last.z; ++batch.row.z) {
    for (; batch.row.y <= last.y; ++batch.row.y) {
      if (words_left == 0) return false;
      std::size_t words = 1;
      batch.changed_cells += apply_row(edit, batch.row, words);
      words_left -= std::min(words_left, words);
    }
    batch.row.y = first.y;
  }
  return true;
}

// The part of the edit in one row; adds to `words` what it cost.
std::size_t EditQueue::apply_row(const CellEdit& edit, Cell row, std::size_t& words) noexcept {
  const auto set = [&](std::int32_t first, std::int32_t last) -> std::size_t {
    if (first > last) return 0;
    words += static_cast<std::size_t>(last - first) / 64;
    return world_->set_row({first, row.y, row.z}, last + 1, edit.value);
  };
  if (edit.kind == CellEdit::Kind::Paint) {
    const VoxelGrid& grid = *world_->grid();
    const double y_m = center_of_m(grid, 1, row.y) - edit.center.y;
    const double z_m = center_of_m(grid, 2, row.z) - edit.center.z;
    const double rest_m2 = edit.radius_m * edit.radius_m - (y_m * y_m + z_m * z_m);
    if (!(rest_m2 >= 0)) return 0;
    const auto [first, last] = cells_within(grid, 0, edit.center.x, std::sqrt(rest_m2));
    return set(first, last);
  }
  const bool is_outer = row.y == edit.first.y || row.y == edit.last.y || row.z == edit.first.z ||
                        row.z == edit.last.z || edit.last.x - edit.first.x < 2;
  if (edit.kind == CellEdit::Kind::Fill || is_outer) return set(edit.first.x, edit.last.x);
  return set(edit.first.x, edit.first.x) + set(edit.last.x, edit.last.x);
}

}  // namespace thimble::world
