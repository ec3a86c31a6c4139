#include "lab/stability/largest.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::lab {
namespace {

constexpr double kPrecision = 1.01;
constexpr double kStride = 1.25;

}  // namespace

Result<Largest> largest_stable(SearchRange range,
                               const std::function<Result<bool>(double newton_per_m)>& is_stable) {
  double stable = 0;
  double next = range.low_newton_per_m;
  for (;;) {
    const auto found = is_stable(next);
    if (!found) return tl::unexpected(found.error());
    if (!*found && stable == 0) return Largest{.newton_per_m = next, .is_at_low = true};
    if (*found && next == range.high_newton_per_m)
      return Largest{.newton_per_m = next, .is_at_high = true};
    if (!*found) {
      range.high_newton_per_m = next;
      break;
    }
    stable = next;
    next = std::min(kStride * stable, range.high_newton_per_m);
  }
  while (range.high_newton_per_m > kPrecision * stable) {
    const double middle = std::sqrt(stable * range.high_newton_per_m);
    const auto found = is_stable(middle);
    if (!found) return tl::unexpected(found.error());
    (*found ? stable : range.high_newton_per_m) = middle;
  }
  return Largest{.newton_per_m = std::sqrt(stable * range.high_newton_per_m)};
}

}  // namespace thimble::lab
