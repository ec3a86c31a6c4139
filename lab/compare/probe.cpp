#include <algorithm>
#include <cmath>
#include <limits>

#include "lab/compare/scenarios.hpp"
#include "lab/trial/plane_fit.hpp"

namespace thimble::lab {
namespace {

// SOURCE: teleop.md section 5, M1 to M3; reach: its section 1. Ours: what comes after the contact,
// and from where: farther than a buffer zone reaches, which would be full at rest. The other is the
// start of teleop.md 3, as far as a zone reaches: decision 0441.
constexpr double kBefore_m = 0.060;
constexpr double kNearBefore_m = 0.030;
constexpr double kSpeed_m_per_s = 0.2;
constexpr double kReach_m = 0.0635;
constexpr double kFelt_newton = 0.5;
constexpr double kFirst_m = 0.005;
constexpr double kLongest_s = 4;
constexpr double kStroke_m = 0.002;
constexpr double kStroke_hz = 1;
constexpr double kStrokes_s = 3;
constexpr double kPressing_newton = 0.05;  // as an arm's own friction
constexpr double kLeastSpread_m = 1e-4;    // a tenth of a millimeter tells no stiffness
constexpr double kTick_s = 1e-3;
constexpr double kPi = 3.14159265358979323846;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Until the wall is felt, beyond what dragged before it. False: it never was.
bool approach(Stage& stage, Position3& tip, Probed& into) {
  double touched_s = kNone;
  double drag_newton = 0;
  while (stage.now_s() < kLongest_s) {
    const double before_m = tip.x;
    tip.x = std::min(tip.x + kSpeed_m_per_s * kTick_s, kReach_m);
    const Felt& felt = stage.tick(tip, {(tip.x - before_m) / kTick_s, 0, 0});
    if (std::isnan(touched_s) && tip.x >= kWall_m) {
      touched_s = felt.now_s;
      drag_newton = std::max(0.0, -felt.force.x);
    }
    if (std::isnan(touched_s) || -felt.force.x <= drag_newton + kFelt_newton) continue;
    into.onset_s = felt.now_s - touched_s;
    into.displacement_m = std::abs(tip.x - kWall_m);
    return true;
  }
  return false;
}

Result<Probed> probe(const CouplingCase& of, const StageSettings& settings, double away_m) {
  const Position3 start{kWall_m - away_m, kBeside_m, 0};
  auto stage = Stage::create(of, settings, start);
  if (!stage) return tl::unexpected(stage.error());
  Probed probed{.onset_s = kNone, .stiffness_newton_per_m = kNone, .displacement_m = kNone};
  Position3 tip = start;
  if (!approach(**stage, tip, probed)) return probed;
  const double middle_m = tip.x;
  const double omega_per_s = 2 * kPi * kStroke_hz;
  const double from_s = (*stage)->now_s();
  PlaneFit fit;
  for (double t_s = 0; t_s < kStrokes_s; t_s = (*stage)->now_s() - from_s) {
    const double before_m = tip.x;
    const double angle_rad = omega_per_s * (t_s + kTick_s);
    tip.x = std::min(middle_m + kStroke_m * std::sin(angle_rad), kReach_m);
    const Felt& felt = (*stage)->tick(tip, {(tip.x - before_m) / kTick_s, 0, 0});
    const bool is_first = std::abs(tip.x - middle_m) <= kFirst_m;
    if (is_first && -felt.force.x > kPressing_newton)
      fit.add(tip.x, felt.velocity.x, -felt.force.x);
  }
  if (fit.spread() >= kLeastSpread_m) probed.stiffness_newton_per_m = fit.slope();
  return probed;
}

}  // namespace

Result<void> play_probe(const CouplingCase& of, const StageSettings& settings, Measures& into) {
  const auto far = probe(of, settings, kBefore_m);
  if (!far) return tl::unexpected(far.error());
  const auto near = probe(of, settings, kNearBefore_m);
  if (!near) return tl::unexpected(near.error());
  into.probed = *far;
  into.probed_near = *near;
  return {};
}

void list_probe(std::vector<Parameter>& into) {
  into.insert(into.end(), {{"probe: before_wall", "m", kBefore_m},
                           {"probe: before_wall_near", "m", kNearBefore_m},
                           {"probe: speed", "m/s", kSpeed_m_per_s},
                           {"probe: felt_from", "N", kFelt_newton},
                           {"probe: stiffness_within", "m", kFirst_m},
                           {"probe: stroke", "m", kStroke_m},
                           {"probe: stroke_rate", "Hz", kStroke_hz},
                           {"probe: strokes_for", "s", kStrokes_s},
                           {"probe: gives_up_after", "s", kLongest_s},
                           {"probe: reach", "m", kReach_m},
                           {"probe: pressing_from", "N", kPressing_newton},
                           {"probe: least_spread", "m", kLeastSpread_m}});
}

}  // namespace thimble::lab
