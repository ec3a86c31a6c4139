#pragma once

#include <functional>

#include "hal/base/result.hpp"

namespace thimble::lab {

// Where to look for the largest stable stiffness, N/m.
struct SearchRange {
  double low_newton_per_m{0};   // > 0
  double high_newton_per_m{0};  // > low
};

struct Largest {
  double newton_per_m{0};
  bool is_at_low{false};   // nothing in the range is stable: the lowest
  bool is_at_high{false};  // all of it is: the highest
};

// Upwards from `low_newton_per_m` in steps of a quarter to the first that is not stable, then
// between the two to 1 %: a delayed loop may be stable again where it is stiffer. Errors: the first
// of `is_stable`.
[[nodiscard]] Result<Largest> largest_stable(
    SearchRange range, const std::function<Result<bool>(double newton_per_m)>& is_stable);

}  // namespace thimble::lab
