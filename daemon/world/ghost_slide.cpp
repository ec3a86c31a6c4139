#include "daemon/world/ghost_slide.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace thimble::world {
namespace {

using AxisMask = unsigned;  // bit a: axis a
constexpr AxisMask bit(std::size_t axis) noexcept { return 1U << axis; }
constexpr bool has(AxisMask mask, std::size_t axis) noexcept { return (mask & bit(axis)) != 0; }
constexpr std::size_t kSubsets = 8;

// One leg after another: within a leg the point moves on a straight line; a leg ends where a
// stopped axis comes free.
template <class Cells>
class Slider {
 public:
  Slider(const Cells& grid, GhostPoint from, Position3 target) noexcept
      : grid_(grid), cell_(from.cell), leg_start_(from.position), target_(target) {}

  // To the next face or faces. False when the target is reached or everything else is stopped.
  bool advance() noexcept {
    AxisMask tied = 0;
    double when = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (held_[axis] != 0) continue;
      way_[axis] = wanted_way(axis);
      if (way_[axis] == 0) continue;
      const double at = crossing_time(axis);
      if (tied != 0 && at > when) continue;
      tied = tied != 0 && at == when ? tied | bit(axis) : bit(axis);
      when = at;
    }
    if (tied == 0) return false;
    const AxisMask crossed = choose_crossing(tied);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (has(crossed, axis)) cell_[axis] += way_[axis];
      if (has(tied & ~crossed, axis)) held_[axis] = static_cast<std::int8_t>(way_[axis]);
    }
    if (crossed != 0 && (held_[0] | held_[1] | held_[2]) != 0) release(crossed, when);
    return true;
  }

  [[nodiscard]] Slide finish() const noexcept {
    Slide slide{{target_, cell_}, held_};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (held_[axis] != 0) {
        slide.ghost.position[axis] = face(axis, held_[axis]);
        continue;
      }
      for (const int way : {-1, 1}) {
        if (target_[axis] != face(axis, way) || !is_wall(axis, way)) continue;
        slide.held[axis] = static_cast<std::int8_t>(way);
      }
    }
    return slide;
  }

 private:
  [[nodiscard]] double face(std::size_t axis, int way) const noexcept {
    return grid_.face_m(axis, cell_[axis] + (way > 0 ? 1 : 0));
  }
  [[nodiscard]] bool is_wall(std::size_t axis, int way) const noexcept {
    Cell next = cell_;
    next[axis] += way;
    return grid_.is_occupied(next);
  }
  [[nodiscard]] int wanted_way(std::size_t axis) const noexcept {
    if (target_[axis] > face(axis, 1)) return 1;
    return target_[axis] < face(axis, -1) ? -1 : 0;
  }
  // Fraction of the leg, 0 to 1. A leg from the face itself has none before it, however short
  // the rest is.
  [[nodiscard]] double crossing_time(std::size_t axis) const noexcept {
    const double before = face(axis, way_[axis]) - leg_start_[axis];
    return before == 0 ? 0 : before / (target_[axis] - leg_start_[axis]);
  }

  // Stopped axes whose way is open in the new cell come free; then a new leg starts here.
  void release(AxisMask crossed, double when) noexcept {
    AxisMask opened = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (held_[axis] != 0 && !is_wall(axis, held_[axis])) opened |= bit(axis);
    }
    if (opened == 0) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double& start = leg_start_[axis];
      if (held_[axis] != 0) {
        start = face(axis, held_[axis]);
      } else if (has(crossed, axis)) {
        start = face(axis, -way_[axis]);
      } else {
        start += when * (target_[axis] - start);
        start = std::clamp(start, face(axis, -1), face(axis, 1));
      }
      if (has(opened, axis)) held_[axis] = 0;
    }
  }

  // Which of the faces met at the same instant are crossed.
  [[nodiscard]] AxisMask choose_crossing(AxisMask tied) const noexcept {
    if ((tied & (tied - 1)) == 0) {
      const std::size_t axis = has(tied, 0) ? 0 : has(tied, 1) ? 1 : 2;
      return is_wall(axis, way_[axis]) ? 0 : tied;
    }
    const auto can_cross = crossable(tied);
    for (AxisMask among = tied; among != 0;) {
      const auto [common, best] = best_maximal(among, can_cross);
      if (best != 0) return best;
      among = common;
    }
    return 0;
  }

  // can_cross[m]: the faces m can be crossed one after another, in some order, through free cells.
  [[nodiscard]] std::array<bool, kSubsets> crossable(AxisMask tied) const noexcept {
    std::array<bool, kSubsets> can_cross{true};
    for (AxisMask mask = 1; mask < kSubsets; ++mask) {
      if ((mask & ~tied) != 0) continue;
      Cell beyond = cell_;
      bool is_reached = false;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!has(mask, axis)) continue;
        beyond[axis] += way_[axis];
        is_reached = is_reached || can_cross[mask & ~bit(axis)];
      }
      can_cross[mask] = is_reached && !grid_.is_occupied(beyond);
    }
    return can_cross;
  }

  // The maximal crossable subset of `among` that leaves least to go; when several are equal in
  // that, none, and what they have in common first.
  [[nodiscard]] std::pair<AxisMask, AxisMask> best_maximal(
      AxisMask among, const std::array<bool, kSubsets>& can_cross) const noexcept {
    AxisMask best = 0;
    AxisMask common = 0;
    std::array<double, 3> best_gain{};
    for (AxisMask mask = 1; mask < kSubsets; ++mask) {
      if ((mask & ~among) != 0 || !can_cross[mask] || !is_maximal(mask, among, can_cross)) continue;
      const auto mask_gain = gain(mask);
      if (common == 0 || mask_gain > best_gain) {
        best = common = mask;
        best_gain = mask_gain;
      } else if (mask_gain == best_gain) {
        best = 0;
        common &= mask;
        if (common == 0) common = kNothingInCommon;
      }
    }
    return {common == kNothingInCommon ? 0 : common, best};
  }
  static constexpr AxisMask kNothingInCommon = kSubsets;

  [[nodiscard]] static bool is_maximal(AxisMask mask, AxisMask among,
                                       const std::array<bool, kSubsets>& can_cross) noexcept {
    for (AxisMask wider = mask + 1; wider < kSubsets; ++wider) {
      if ((wider & ~among) == 0 && (wider & mask) == mask && can_cross[wider]) return false;
    }
    return true;
  }

  // How far the target lies beyond the faces, the farthest first: comparable whatever the order
  // of the axes, without a sum that would round differently.
  [[nodiscard]] std::array<double, 3> gain(AxisMask mask) const noexcept {
    std::array<double, 3> beyond{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (has(mask, axis)) beyond[axis] = std::abs(target_[axis] - face(axis, way_[axis]));
    }
    std::sort(beyond.begin(), beyond.end(), std::greater<>());
    return beyond;
  }

  const Cells& grid_;
  Cell cell_;
  Position3 leg_start_;
  Position3 target_;
  std::array<int, 3> way_{};
  std::array<std::int8_t, 3> held_{};
};

template <class Cells>
Slide slide_through(const Cells& cells, GhostPoint from, Position3 target) noexcept {
  Slider<Cells> slider(cells, from, cells.clamp_near(target));
  while (slider.advance()) {
  }
  return slider.finish();
}

}  // namespace

Slide slide_ghost(const VoxelGrid& grid, GhostPoint from, Position3 target) noexcept {
  return slide_through(grid, from, target);
}

Slide slide_ghost(const NearCells& near, GhostPoint from, Position3 target) noexcept {
  return slide_through(near, from, target);
}

Slide slide_ghost(const OccupancyMirror& mirror, GhostPoint from, Position3 target) noexcept {
  return slide_through(mirror, from, target);
}

}  // namespace thimble::world
