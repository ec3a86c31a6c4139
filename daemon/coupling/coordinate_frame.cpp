#include "daemon/coupling/coordinate_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace thimble::coupling {

double symmetric_length_m(Displacement3 v) noexcept {
  std::array<double, 3> size{std::abs(v.x), std::abs(v.y), std::abs(v.z)};
  std::sort(size.begin(), size.end());
  return norm(size[0], size[1], size[2]);
}

void CoordinateFrame::shift(Displacement3 by) noexcept {
  if (symmetric_length_m(offset_ + by) <= max_offset_m_) {
    offset_ += by;
    return;
  }
  const double length_m = symmetric_length_m(by);
  if (!std::isfinite(length_m) || !(length_m > 0)) return;
  const Displacement3 way = (1 / length_m) * by;
  const double along_m = dot(way, offset_);
  const double room_m2 = max_offset_m_ * max_offset_m_ - dot(offset_, offset_);
  const double reach_m = std::sqrt(std::max(0.0, along_m * along_m + room_m2)) - along_m;
  offset_ += std::clamp(reach_m, 0.0, length_m) * way;
}

}  // namespace thimble::coupling
