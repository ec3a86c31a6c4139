#include "daemon/world/push_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdlib>

namespace thimble::world {
namespace {

// Ours: rounds of equally near exits passed over before the search gives up.
constexpr int kMaxTies = 8;

struct Candidate {
  GhostPoint at{};
  double distance2_m2{0};
  double along_bias{0};
  std::int32_t cells_away{0};
  double cell_along_bias{0};
};

// Less is better.
[[nodiscard]] std::partial_ordering compare(const Candidate& a, const Candidate& b) noexcept {
  if (a.distance2_m2 != b.distance2_m2) return a.distance2_m2 <=> b.distance2_m2;
  if (a.along_bias != b.along_bias) return b.along_bias <=> a.along_bias;
  if (a.cells_away != b.cells_away) return a.cells_away <=> b.cells_away;
  return b.cell_along_bias <=> a.cell_along_bias;
}

[[nodiscard]] Candidate rate(const VoxelGrid& grid, const ExitQuery& query, Cell cell) noexcept {
  Candidate candidate;
  candidate.at.cell = cell;
  std::array<double, 3> square{};
  std::array<double, 3> along{};
  std::array<double, 3> cell_along{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double from = query.anchor[axis];
    const double to =
        std::clamp(from, grid.face_m(axis, cell[axis]), grid.face_m(axis, cell[axis] + 1));
    candidate.at.position[axis] = to;
    const std::int32_t steps = cell[axis] - query.home[axis];
    candidate.cells_away += std::abs(steps);
    square[axis] = (to - from) * (to - from);
    along[axis] = (to - from) * query.bias[axis];
    cell_along[axis] = steps * query.bias[axis];
  }
  candidate.distance2_m2 = symmetric_sum(square[0], square[1], square[2]);
  candidate.along_bias = symmetric_sum(along[0], along[1], along[2]);
  candidate.cell_along_bias = symmetric_sum(cell_along[0], cell_along[1], cell_along[2]);
  return candidate;
}

struct Box {
  Cell first{};
  Cell last{};
};

// The cells that touch the anchor, and `reach` more on every side, within the grid.
[[nodiscard]] Box neighbourhood(const VoxelGrid& grid, const ExitQuery& query) noexcept {
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto end = static_cast<std::int32_t>(grid.cells()[axis]) - 1;
    const std::int32_t lower = grid.lower_index(axis, query.anchor[axis]);
    const bool is_on_face = query.anchor[axis] == grid.face_m(axis, lower + 1);
    box.first[axis] = std::max(lower - query.reach, 0);
    box.last[axis] = std::min(lower + (is_on_face ? 1 : 0) + query.reach, end);
  }
  return box;
}

// Best of the free cells farther than `beyond_m2`; `is_alone` false when another equals it.
struct Round {
  std::optional<Candidate> best{};
  bool is_alone{true};
};

[[nodiscard]] Round search(const VoxelGrid& grid, const ExitQuery& query,
                           double beyond_m2) noexcept {
  const Box box = neighbourhood(grid, query);
  Round round;
  for (Cell cell{0, 0, box.first.z}; cell.z <= box.last.z; ++cell.z) {
    for (cell.y = box.first.y; cell.y <= box.last.y; ++cell.y) {
      for (cell.x = box.first.x; cell.x <= box.last.x; ++cell.x) {
        if (grid.is_occupied(cell)) continue;
        const Candidate candidate = rate(grid, query, cell);
        if (!(candidate.distance2_m2 > beyond_m2)) continue;
        if (query.is_bound && candidate.along_bias < 0) continue;
        const auto order =
            round.best ? compare(candidate, *round.best) : std::partial_ordering::less;
        if (order < 0) round = {candidate, true};
        if (order == 0) round.is_alone = false;
      }
    }
  }
  return round;
}

}  // namespace

double symmetric_sum(double a, double b, double c) noexcept {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  return (a + b) + c;
}

std::optional<Exit> find_exit(const VoxelGrid& grid, const ExitQuery& query) noexcept {
  ExitQuery near = query;
  near.anchor = grid.clamp_near(query.anchor);
  double beyond_m2 = -1;
  for (int round = 0; round < kMaxTies; ++round) {
    const auto [best, is_alone] = search(grid, near, beyond_m2);
    if (!best) return std::nullopt;
    if (is_alone) return Exit{best->at, std::sqrt(best->distance2_m2)};
    beyond_m2 = best->distance2_m2;
  }
  return std::nullopt;
}

}  // namespace thimble::world
