#include "lab/stability/theory.hpp"

#include <cmath>

namespace thimble::lab {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kHalvings = 60;  // of an interval of doubles

}  // namespace

double short_delay_limit_newton_per_m(double damping_newton_s_per_m, double delay_s,
                                      double period_s) {
  return damping_newton_s_per_m / (period_s / 2 + delay_s);
}

Crossing any_delay_limit(double mass_kg, double damping_newton_s_per_m, double delay_s,
                         double period_s) {
  const double late_s = delay_s + period_s / 2;
  // x·tan(x) grows from 0 without end.
  const double wanted = damping_newton_s_per_m * late_s / mass_kg;
  double low = 0;
  double high = kPi / 2;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (middle * std::tan(middle) < wanted ? low : high) = middle;
  }
  const double omega_per_s = low / late_s;
  return {.newton_per_m = damping_newton_s_per_m * omega_per_s / std::sin(low),
          .swing_hz = omega_per_s / (2 * kPi)};
}

double both_ends_limit_newton_per_m(double damping_newton_s_per_m, double delay_s,
                                    double period_s) {
  return 2 * damping_newton_s_per_m / (delay_s + period_s);
}

double world_end_limit_newton_per_m(double damping_newton_s_per_m, double delay_s,
                                    double period_s) {
  return 1.5 * damping_newton_s_per_m / (delay_s + period_s);
}

}  // namespace thimble::lab
