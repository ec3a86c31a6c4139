#include "daemon/world/free_rows.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace thimble::world {
namespace {

double distance_to_cell_m(const VoxelGrid& grid, std::size_t axis, std::int32_t index,
                          double p) noexcept {
  return std::max({0.0, grid.face_m(axis, index) - p, p - grid.face_m(axis, index + 1)});
}

double square(double a) noexcept { return a * a; }

// The indices of one axis, nearest to `p` first.
class Outwards {
 public:
  Outwards(const VoxelGrid& grid, std::size_t axis, double p) noexcept
      : grid_(grid),
        axis_(axis),
        p_(p),
        end_(static_cast<std::int32_t>(grid.cells()[axis])),
        below_(grid.lower_index(axis, p)),
        above_(below_ + 1) {}

  [[nodiscard]] bool is_over() const noexcept { return below_ < 0 && above_ >= end_; }
  // Index, and its distance.
  std::pair<std::int32_t, double> next() noexcept {
    constexpr double kNone_m = std::numeric_limits<double>::infinity();
    const double below_m = below_ < 0 ? kNone_m : distance_to_cell_m(grid_, axis_, below_, p_);
    const double above_m = above_ >= end_ ? kNone_m : distance_to_cell_m(grid_, axis_, above_, p_);
    if (below_m <= above_m) return {below_--, below_m};
    return {above_++, above_m};
  }

 private:
  const VoxelGrid& grid_;
  std::size_t axis_;
  double p_;
  std::int32_t end_;
  std::int32_t below_;
  std::int32_t above_;
};

}  // namespace

struct FreeRows::Best {
  double distance2_m2{std::numeric_limits<double>::infinity()};
  std::optional<Cell> cell{};

  void offer(double offered2_m2, Cell offered) noexcept {
    const auto order = [](Cell c) { return std::tuple(c.z, c.y, c.x); };
    const bool is_better = offered2_m2 < distance2_m2 ||
                           (offered2_m2 == distance2_m2 && cell && order(offered) < order(*cell));
    if (!is_better) return;
    distance2_m2 = offered2_m2;
    cell = offered;
  }
};

FreeRows::FreeRows(const VoxelGrid& grid)
    : rows_(grid.cells()[1]), may_have_free_(rows_ * grid.cells()[2]), counts_(grid.cells()[2]) {
  const auto end = static_cast<std::int32_t>(grid.cells()[0]);
  for (Cell row; row.z < static_cast<std::int32_t>(grid.cells()[2]); ++row.z) {
    for (row.y = 0; row.y < static_cast<std::int32_t>(rows_); ++row.y) {
      if (grid.next_free_in_row(row) < end) note_freed(row);
    }
  }
}

std::size_t FreeRows::index_of(Cell row) const noexcept {
  return static_cast<std::size_t>(row.y) + rows_ * static_cast<std::size_t>(row.z);
}

void FreeRows::note_freed(Cell row) noexcept {
  const bool is_inside = row.y >= 0 && static_cast<std::size_t>(row.y) < rows_ && row.z >= 0 &&
                         static_cast<std::size_t>(row.z) < counts_.size();
  if (!is_inside || may_have_free_[index_of(row)]) return;
  may_have_free_[index_of(row)] = true;
  ++counts_[static_cast<std::size_t>(row.z)];
}

std::optional<Cell> FreeRows::nearest(const VoxelGrid& grid, Position3 p) noexcept {
  Best best;
  for (Outwards layers(grid, 2, p.z); !layers.is_over();) {
    const auto [z, dz_m] = layers.next();
    if (square(dz_m) > best.distance2_m2) break;
    ++looked_at_;
    if (counts_[static_cast<std::size_t>(z)] > 0) search_layer(grid, p, z, square(dz_m), best);
  }
  return best.cell;
}

void FreeRows::search_layer(const VoxelGrid& grid, Position3 p, std::int32_t z, double dz2_m2,
                            Best& best) noexcept {
  for (Outwards rows(grid, 1, p.y); !rows.is_over();) {
    const auto [y, dy_m] = rows.next();
    const double row2_m2 = square(dy_m) + dz2_m2;
    if (row2_m2 > best.distance2_m2) break;
    ++looked_at_;
    if (may_have_free_[index_of({0, y, z})]) search_row(grid, p, {0, y, z}, row2_m2, best);
  }
}

void FreeRows::search_row(const VoxelGrid& grid, Position3 p, Cell row, double row2_m2,
                          Best& best) noexcept {
  const auto end = static_cast<std::int32_t>(grid.cells()[0]);
  row.x = grid.next_free_in_row(row);
  looked_at_ += grid.cells()[0];
  if (row.x == end) {
    may_have_free_[index_of(row)] = false;
    --counts_[static_cast<std::size_t>(row.z)];
    return;
  }
  for (; row.x < end; ++row.x, row.x = grid.next_free_in_row(row)) {
    const double dx_m = distance_to_cell_m(grid, 0, row.x, p.x);
    best.offer(row2_m2 + square(dx_m), row);
    if (p.x <= grid.face_m(0, row.x)) break;  // what follows is farther
  }
}

}  // namespace thimble::world
