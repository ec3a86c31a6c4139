#include "sim/model/hand/stroke.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::sim {
namespace {

constexpr double kAcceleration = 4;  // m/s²: ours, a quick but unhurried hand

}  // namespace

Stroke::Stroke(Position3 from, Position3 to, double speed_m_per_s) noexcept : from_(from), to_(to) {
  const Displacement3 way = to - from;
  const double length_m = norm(way);
  if (length_m <= 0) return;
  along_ = {way.x / length_m, way.y / length_m, way.z / length_m};
  peak_m_per_s_ = std::min(speed_m_per_s, std::sqrt(length_m * kAcceleration));
  ramp_s_ = peak_m_per_s_ / kAcceleration;
  cruise_s_ = std::max(0.0, length_m / peak_m_per_s_ - ramp_s_);
}

PathPoint Stroke::at(double t_s) const noexcept {
  const double left_s = duration_s() - t_s;
  if (t_s <= 0) return {from_, {}};
  if (left_s <= 0) return {to_, {}};
  if (left_s < ramp_s_) {
    const double rest_m = 0.5 * kAcceleration * left_s * left_s;
    return {to_ - along<struct DisplacementTag>(along_, rest_m),
            along<struct VelocityTag>(along_, kAcceleration * left_s)};
  }
  const double rising_s = std::min(t_s, ramp_s_);
  const double gone_m =
      0.5 * kAcceleration * rising_s * rising_s + peak_m_per_s_ * (t_s - rising_s);
  return {from_ + along<struct DisplacementTag>(along_, gone_m),
          along<struct VelocityTag>(along_, kAcceleration * rising_s)};
}

}  // namespace thimble::sim
