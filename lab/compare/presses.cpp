#include <algorithm>
#include <cmath>
#include <numbers>

#include "lab/compare/judged.hpp"
#include "lab/compare/scenarios.hpp"

// The scenarios of a finger that presses: push, edge and outage.
namespace thimble::lab {
namespace {

// SOURCE: teleop.md section 5, M5. Ours: from where, how long.
constexpr double kPushBy_newton = 2;
constexpr double kPushFrom_m = kWall_m - 0.001;
constexpr double kPushFor_s = 3;

// Ours, but for what the thesis's hand does (M7).
constexpr double kEdgeDepth_m = 0.010;
constexpr double kEdgeFrom_m = -0.030;
constexpr double kEdgeTo_m = 0.045;
constexpr double kEdgeSpeed_m_per_s = 0.1;
constexpr double kEdgeRest_s = 1;
constexpr double kEdgeFelt_newton = 0.1;

// Ours, but for the length of the outage (M9).
constexpr double kStroke_m = 0.010;
constexpr double kStrokeMiddle_m = kWall_m + 0.020;
constexpr double kStroke_hz = 2;
constexpr double kOutageAt_s = 2;
constexpr double kOutageEnd_s = 4.5;
constexpr double kAstrayFrom_newton = 0.2;

// To and fro behind the face, with the outage or without; judged, and what was felt.
Result<std::vector<Felt>> press(const CouplingCase& of, const StageSettings& settings, bool is_cut,
                                Measures& into) {
  const Position3 start{kWall_m - 0.005, kBeside_m, 0};
  auto stage = Stage::create(of, settings, start);
  if (!stage) return tl::unexpected(stage.error());
  Finger finger(start, (*stage)->dt());
  constexpr double kOmega_per_s = 2 * std::numbers::pi * kStroke_hz;
  while ((*stage)->now_s() < kOutageEnd_s) {
    if (is_cut && (*stage)->now_s() >= kOutageAt_s) {
      (*stage)->cut_network(kOutage_s);
      is_cut = false;
    }
    const Felt& felt = (*stage)->tick(finger.tip(), finger.seen_velocity());
    const double angle_rad = kOmega_per_s * felt.now_s;
    finger.move({.at = {kStrokeMiddle_m + kStroke_m * std::sin(angle_rad), kBeside_m, 0},
                 .moving = {kOmega_per_s * kStroke_m * std::cos(angle_rad), 0, 0}},
                felt.force);
  }
  judge_forces((*stage)->history(), into);
  judge_energy(of, (*stage)->history(), finger, into);
  return (*stage)->history();
}

}  // namespace

Result<void> play_push(const CouplingCase& of, const StageSettings& settings, Measures& into) {
  const Position3 start{kPushFrom_m, kBeside_m, 0};
  auto stage = Stage::create(of, settings, start);
  if (!stage) return tl::unexpected(stage.error());
  Finger finger(start, (*stage)->dt());
  const FingerGoal goal{.at = {0, kBeside_m, 0}, .push_newton = kPushBy_newton, .is_pushing = true};
  double squares = 0;
  double ticks = 0;
  while ((*stage)->now_s() < kPushFor_s) {
    const Felt& felt = (*stage)->tick(finger.tip(), finger.seen_velocity());
    finger.move(goal, felt.force);
    if (felt.now_s <= kPushFor_s - 1) continue;
    squares += (-felt.force.x - kPushBy_newton) * (-felt.force.x - kPushBy_newton);
    ticks += 1;
  }
  into.push_error_newton = std::sqrt(squares / ticks);
  judge_forces((*stage)->history(), into);
  judge_energy(of, (*stage)->history(), finger, into);
  return {};
}

Result<void> play_edge(const CouplingCase& of, const StageSettings& settings, Measures& into) {
  const Position3 start{kWall_m - 0.005, kEdgeFrom_m, 0};
  auto stage = Stage::create(of, settings, start);
  if (!stage) return tl::unexpected(stage.error());
  Finger finger(start, (*stage)->dt());
  const double end_s = kEdgeRest_s + (kEdgeTo_m - kEdgeFrom_m) / kEdgeSpeed_m_per_s;
  into.edge_m = 0;
  while ((*stage)->now_s() < end_s) {
    const Felt& felt = (*stage)->tick(finger.tip(), finger.seen_velocity());
    const double slid_s = std::max(0.0, felt.now_s - kEdgeRest_s);
    FingerGoal goal{.at = {kWall_m + kEdgeDepth_m, kEdgeFrom_m + kEdgeSpeed_m_per_s * slid_s, 0}};
    if (slid_s > 0) goal.moving.y = kEdgeSpeed_m_per_s;
    finger.move(goal, felt.force);
    if (-felt.force.x > kEdgeFelt_newton) into.edge_m = std::max(into.edge_m, felt.tip.y);
  }
  judge_forces((*stage)->history(), into);
  judge_energy(of, (*stage)->history(), finger, into);
  return {};
}

Result<void> play_outage(const CouplingCase& of, const StageSettings& settings, Measures& into) {
  const auto undisturbed = press(of, settings, false, into);
  if (!undisturbed) return tl::unexpected(undisturbed.error());
  const auto cut = press(of, settings, true, into);
  if (!cut) return tl::unexpected(cut.error());
  into.astray_newton = into.astray_s = 0;
  for (std::size_t tick = 0; tick < cut->size(); ++tick) {
    const Felt& felt = (*cut)[tick];
    const double astray_newton = std::abs(felt.force.x - (*undisturbed)[tick].force.x);
    into.astray_newton = std::max(into.astray_newton, astray_newton);
    if (astray_newton <= kAstrayFrom_newton) continue;
    into.astray_s = std::max(into.astray_s, felt.now_s - kOutageAt_s - kOutage_s);
  }
  return {};
}

void list_presses(std::vector<Parameter>& into) {
  into.insert(into.end(), {{"push: force", "N", kPushBy_newton},
                           {"push: before_wall", "m", kWall_m - kPushFrom_m},
                           {"push: for", "s", kPushFor_s},
                           {"edge: behind_wall", "m", kEdgeDepth_m},
                           {"edge: from", "m", kEdgeFrom_m},
                           {"edge: to", "m", kEdgeTo_m},
                           {"edge: speed", "m/s", kEdgeSpeed_m_per_s},
                           {"edge: rests_for", "s", kEdgeRest_s},
                           {"edge: felt_from", "N", kEdgeFelt_newton},
                           {"outage: stroke", "m", kStroke_m},
                           {"outage: middle_behind_wall", "m", kStrokeMiddle_m - kWall_m},
                           {"outage: stroke_rate", "Hz", kStroke_hz},
                           {"outage: at", "s", kOutageAt_s},
                           {"outage: ends", "s", kOutageEnd_s},
                           {"outage: astray_from", "N", kAstrayFrom_newton}});
}

}  // namespace thimble::lab
