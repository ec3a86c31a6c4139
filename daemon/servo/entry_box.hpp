#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// Where a finger may begin to feel: where its world is free at all. Outside of that all is matter,
// which nobody sees and which would push the hand with all that the arm has (decision 0499).
//
// Frame: base frame of the arm, m. Thread: any. RT: pure. Errors: none; a position that is none is
// nowhere inside of what has an end.
struct EntryBox {
  // How deep in an outermost wall a finger may begin: who was stopped while leaning on one goes on
  // after the clear, and a ghost that begins there takes its wall to the finger, without a kick.
  // Ours: no hand presses deeper, 8.5 N at 500 N/m are 17 mm.
  static constexpr double kLean_m = 0.02;

  Position3 center{};
  std::array<double, 3> half_m{};  // along x, y, z; no more than 0 where the world has no end

  [[nodiscard]] THIMBLE_RT bool contains(Position3 tip) const noexcept {
    const std::array<double, 3> from_center_m{tip.x - center.x, tip.y - center.y, tip.z - center.z};
    for (std::size_t axis = 0; axis < half_m.size(); ++axis) {
      const double end_m = half_m[axis];
      if (end_m > 0 && !(std::abs(from_center_m[axis]) <= end_m + kLean_m)) return false;
    }
    return true;
  }
};

}  // namespace thimble::servo
