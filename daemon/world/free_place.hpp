#pragma once

#include <algorithm>
#include <optional>

#include "hal/base/geometry.hpp"

namespace thimble::world {

// A free place near `hand`: itself, else the first on a straight way in one of 26 directions, the
// nearest of those; none where there is none within 10 m. `depth_m(place)` says how deep a place is
// in matter, <= 0 where it is free, and never more than the way out; `least_step_m` is what is gone
// where it says less. Control plane: takes up to some milliseconds. Errors: none.
template <class Depth>
[[nodiscard]] std::optional<Position3> find_free_place(const Depth& depth_m, Position3 hand,
                                                       double least_step_m) noexcept {
  constexpr double kSearch_m = 10;
  if (depth_m(hand) <= 0) return hand;
  std::optional<Position3> best;
  double best_m = kSearch_m;
  for (int direction = 0; direction < 27; ++direction) {
    const int second = direction / 3 % 3;
    const int third = direction / 9;
    const Displacement3 way{direction % 3 - 1.0, second - 1.0, third - 1.0};
    if (way == Displacement3{}) continue;
    const double scale = 1 / norm(way);
    for (double gone_m = 0; gone_m < best_m;) {
      const Position3 at = hand + (gone_m * scale) * way;
      const double inside_m = depth_m(at);
      if (inside_m <= 0) {
        best = at;
        best_m = gone_m;
        break;
      }
      gone_m += std::max(inside_m, least_step_m);
    }
  }
  return best;
}

}  // namespace thimble::world
