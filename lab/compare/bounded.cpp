#include "lab/compare/bounded.hpp"

#include "daemon/coupling/ghost_point_arm.hpp"
#include "lab/compare/measures.hpp"
#include "lab/compare/stage.hpp"
#include "lab/stability/theory.hpp"
#include "lab/trial/finger.hpp"

namespace thimble::lab {
namespace {

constexpr double kServoPeriod_s = 1e-3;

double wall_newton_per_m() { return coupling::GhostPointSettings{}.stiffness.newton_per_m; }

}  // namespace

double wall_work_joule() noexcept {
  const double wall = wall_newton_per_m();
  const double finger = FingerSettings{}.stiffness_newton_per_m;
  const double pressed_newton = wall * finger / (wall + finger) * kHeldBehind_m;
  return pressed_newton * kStageCell_m + wall * kStageCell_m * kStageCell_m / 2;
}

// Written so that what is not a number is not bounded.
bool is_bounded(const HeldAtWall& held) noexcept {
  return held.swing_last_m <= kGrowsTo_ratio * held.swing_before_m + kGrows_m &&
         held.given_joule <= wall_work_joule() && held.most_newton <= kMost_newton;
}

bool may_grow(coupling::Scheme scheme, double late_s) noexcept {
  if (scheme != coupling::Scheme::RemoteForce) return false;
  const FingerSettings finger;
  const Crossing limit =
      any_delay_limit(finger.mass_kg, finger.damping_newton_s_per_m, late_s, kServoPeriod_s);
  return wall_newton_per_m() > limit.newton_per_m;
}

bool may_give(coupling::Scheme scheme, bool has_outages) noexcept {
  if (scheme == coupling::Scheme::RemoteForce) return true;
  return scheme == coupling::Scheme::SpringDamper && has_outages;
}

bool may_ask_for_more(coupling::Scheme scheme) noexcept { return may_give(scheme, true); }

}  // namespace thimble::lab
