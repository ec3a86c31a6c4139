#include "daemon/coupling/told_planes.hpp"

#include <algorithm>

#include "daemon/coupling/wall_penalty.hpp"

namespace thimble::coupling {
namespace {

constexpr double kSameNormalCosine = 1 - 1e-9;

}  // namespace

PlaneList sound_planes(const PlaneList& planes, std::uint64_t& rejected) noexcept {
  PlaneList sound;
  for (const ConstraintPlane& plane : planes) {
    if (!is_sound(plane)) {
      ++rejected;
      continue;
    }
    auto* const twin = std::find_if(sound.begin(), sound.end(), [&](const ConstraintPlane& other) {
      return dot(other.normal, plane.normal) >= kSameNormalCosine;
    });
    if (twin == sound.end()) {
      sound.push_back(plane);
    } else if (plane.offset_m < twin->offset_m) {
      *twin = plane;
    }
  }
  return sound;
}

double effective_hysteresis_m(double hysteresis_m, double cell_m) noexcept {
  return cell_m > 0 ? std::min(hysteresis_m, cell_m / 4) : hysteresis_m;
}

}  // namespace thimble::coupling
