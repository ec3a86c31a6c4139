#include "hal/base/geometry.hpp"

#include <cmath>

namespace thimble {

double norm_of_extremes(double x, double y, double z) noexcept {
  if (x == 0 && y == 0 && z == 0) return 0;  // by far the most frequent
  return std::hypot(x, y, z);
}

}  // namespace thimble
