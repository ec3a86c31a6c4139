#include "daemon/world/free_rows.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <tuple>
#include <utility>

namespace thimble::world {
namespace {

constexpr std::size_t kWordBits = 64;

double distance_to_cell_m(const VoxelGrid& grid, std::size_t axis, std::int32_t index,
                          double p) noexcept {
  return std::max({0.0, grid.face_m(axis, index) - p, p - grid.face_m(axis, index + 1)});
}

double square(double a) noexcept { return a * a; }

// Of one index below `p` and one above it the nearer, with its distance; outside of the grid is
// nothing, and not both may be.
std::pair<std::int32_t, double> nearer(const VoxelGrid& grid, std::size_t axis, std::int32_t below,
                                       std::int32_t above, double p) noexcept {
  constexpr double kNone_m = std::numeric_limits<double>::infinity();
  const auto end = static_cast<std::int32_t>(grid.cells()[axis]);
  const double below_m = below < 0 ? kNone_m : distance_to_cell_m(grid, axis, below, p);
  const double above_m = above >= end ? kNone_m : distance_to_cell_m(grid, axis, above, p);
  if (below_m <= above_m) return {below, below_m};
  return {above, above_m};
}

// The first bit that is set from `from` on; behind all of them when none is.
std::int32_t first_set(std::span<const std::uint64_t> words, std::int32_t from) noexcept {
  const std::size_t end = words.size() * kWordBits;
  for (auto bit = static_cast<std::size_t>(from); bit < end; bit += kWordBits - bit % kWordBits) {
    const std::uint64_t rest = words[bit / kWordBits] >> bit % kWordBits;
    if (rest != 0) return static_cast<std::int32_t>(bit) + std::countr_zero(rest);
  }
  return static_cast<std::int32_t>(end);
}

// The last one up to `from`; -1 when none is.
std::int32_t last_set(std::span<const std::uint64_t> words, std::int32_t from) noexcept {
  while (from >= 0) {
    const auto bit = static_cast<std::size_t>(from);
    const std::uint64_t rest = words[bit / kWordBits] << (kWordBits - 1 - bit % kWordBits);
    if (rest != 0) return from - std::countl_zero(rest);
    from -= static_cast<std::int32_t>(bit % kWordBits) + 1;
  }
  return -1;
}

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
    const auto found = nearer(grid_, axis_, below_, above_, p_);
    if (found.first == below_) {
      --below_;
    } else {
      ++above_;
    }
    return found;
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
    : rows_(grid.cells()[1]),
      words_((rows_ + kWordBits - 1) / kWordBits),
      has_free_(words_ * grid.cells()[2]),
      counts_(grid.cells()[2]) {
  for (Cell row; row.z < static_cast<std::int32_t>(grid.cells()[2]); ++row.z) {
    for (row.y = 0; row.y < static_cast<std::int32_t>(rows_); ++row.y) note_changed(grid, row);
  }
}

std::span<std::uint64_t> FreeRows::layer(std::int32_t z) noexcept {
  return std::span(has_free_).subspan(words_ * static_cast<std::size_t>(z), words_);
}

void FreeRows::note_changed(const VoxelGrid& grid, Cell row) noexcept {
  const bool is_inside = row.y >= 0 && static_cast<std::size_t>(row.y) < rows_ && row.z >= 0 &&
                         static_cast<std::size_t>(row.z) < counts_.size();
  if (!is_inside) return;
  const auto bit = static_cast<std::size_t>(row.y);
  const std::uint64_t mask = std::uint64_t{1} << bit % kWordBits;
  std::uint64_t& word = layer(row.z)[bit / kWordBits];
  row.x = 0;
  const bool has_free = grid.next_free_in_row(row) < static_cast<std::int32_t>(grid.cells()[0]);
  if (has_free == ((word & mask) != 0)) return;
  word ^= mask;
  std::uint32_t& count = counts_[static_cast<std::size_t>(row.z)];
  count = has_free ? count + 1 : count - 1;
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
  const auto has_free = layer(z);
  const std::int32_t start = grid.lower_index(1, p.y);
  std::int32_t below = last_set(has_free, start);
  std::int32_t above = first_set(has_free, start + 1);
  while (below >= 0 || above < static_cast<std::int32_t>(rows_)) {
    const auto [y, dy_m] = nearer(grid, 1, below, above, p.y);
    const double row2_m2 = square(dy_m) + dz2_m2;
    if (row2_m2 > best.distance2_m2) break;
    search_row(grid, p, {0, y, z}, row2_m2, best);
    if (y == below) {
      below = last_set(has_free, below - 1);
    } else {
      above = first_set(has_free, above + 1);
    }
  }
}

void FreeRows::search_row(const VoxelGrid& grid, Position3 p, Cell row, double row2_m2,
                          Best& best) noexcept {
  const auto end = static_cast<std::int32_t>(grid.cells()[0]);
  looked_at_ += grid.cells()[0];
  for (row.x = grid.next_free_in_row(row); row.x < end;
       ++row.x, row.x = grid.next_free_in_row(row)) {
    const double dx_m = distance_to_cell_m(grid, 0, row.x, p.x);
    best.offer(row2_m2 + square(dx_m), row);
    if (p.x <= grid.face_m(0, row.x)) break;  // what follows is farther
  }
}

}  // namespace thimble::world
