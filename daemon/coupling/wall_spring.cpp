#include "daemon/coupling/wall_spring.hpp"

#include <algorithm>

namespace thimble::coupling {

void WallSpring::reset(Stiffness stiffness) noexcept {
  stiffness_ = stiffness;
  gap_m_ = 0;
  knee_m_ = 0;
  knee_newton_ = 0;
}

// The line to the knee is as long as what is stored allows: its triangle is the energy.
void WallSpring::become(Stiffness stiffness, double depth_m) noexcept {
  const double plain_newton = stiffness.newton_per_m * std::max(0.0, depth_m);
  const double newton = std::min(force_newton(depth_m), plain_newton);
  const double joule = energy_joule(depth_m);
  stiffness_ = stiffness;
  if (!(newton > 0)) {
    knee_m_ = gap_m_;
    knee_newton_ = 0;
    return;
  }
  knee_m_ = depth_m;
  knee_newton_ = newton;
  gap_m_ = std::max(0.0, depth_m - 2 * joule / newton);
}

void WallSpring::sink(double by_m) noexcept {
  if (!(by_m > 0)) return;
  gap_m_ += by_m;
  knee_m_ += by_m;
}

double WallSpring::force_newton(double depth_m) const noexcept {
  if (!(depth_m > gap_m_)) return 0;
  if (depth_m >= knee_m_) return knee_newton_ + stiffness_.newton_per_m * (depth_m - knee_m_);
  return knee_newton_ * (depth_m - gap_m_) / (knee_m_ - gap_m_);
}

double WallSpring::energy_joule(double depth_m) const noexcept {
  if (!(depth_m > gap_m_)) return 0;
  const double newton = force_newton(depth_m);
  if (depth_m < knee_m_) return newton * (depth_m - gap_m_) / 2;
  const double to_knee_joule = knee_newton_ * (knee_m_ - gap_m_) / 2;
  return to_knee_joule + (knee_newton_ + newton) / 2 * (depth_m - knee_m_);
}

}  // namespace thimble::coupling
