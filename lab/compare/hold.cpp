#include <algorithm>
#include <cmath>

#include "lab/compare/bounded.hpp"
#include "lab/compare/scenarios.hpp"
#include "lab/trial/spread.hpp"

namespace thimble::lab {
namespace {

// Ours. Two periods of the wall, until what came of the contact is over; then twice as long as wall
// and outages need to meet as they did before, so that a hand that goes on as it was does the same
// again.
constexpr double kPeriod_s = 2 * kMoveEvery_s;
constexpr double kSettles_s = 2 * kPeriod_s;
constexpr double kPeriods = 3;
constexpr double kPeriodsOfOutages = 15;  // 21 s: 14 times kOutageEvery_s
constexpr double kFrom_m = kWall_m - 0.005;

}  // namespace

Result<void> play_hold(const CouplingCase& of, const StageSettings& settings, Measures& into) {
  const Position3 start{kFrom_m, kBeside_m, 0};
  auto stage = Stage::create(of, settings, start);
  if (!stage) return tl::unexpected(stage.error());
  Finger finger(start, (*stage)->dt());
  const double periods = settings.has_outages ? kPeriodsOfOutages : kPeriods;
  const double half_s = kSettles_s + periods * kPeriod_s;
  const double end_s = half_s + periods * kPeriod_s;
  Spread before;
  Spread last;
  Spread pressed;
  double given_before_joule = 0;
  into.held = {};
  while ((*stage)->now_s() < end_s) {
    const Felt& felt = (*stage)->tick(finger.tip(), finger.seen_velocity());
    finger.move({.at = {kWall_m + kHeldBehind_m, kBeside_m, 0}}, felt.force);
    if (felt.now_s < kSettles_s) continue;
    const bool is_last = felt.now_s >= half_s;
    (is_last ? last : before).add(felt.tip.x);
    if (is_last) pressed.add(-felt.force.x);
    if (!is_last) given_before_joule = finger.energy().given_joule();
    const double newton = norm(felt.force.x, felt.force.y, felt.force.z);
    into.held.most_newton = std::max(into.held.most_newton, newton);
  }
  // A force that is no number leaves none of the finger.
  if (!std::isfinite(finger.tip().x)) into.held.most_newton = std::nan("");
  into.held.swing_before_m = before.most() - before.least();
  into.held.last_newton = pressed.mean();
  into.held.swing_last_m = last.most() - last.least();
  into.held.given_joule = (finger.energy().given_joule() - given_before_joule) / periods;
  return {};
}

void list_hold(std::vector<Parameter>& into) {
  into.insert(into.end(), {{"hold: before_wall", "m", kWall_m - kFrom_m},
                           {"hold: behind_wall", "m", kHeldBehind_m},
                           {"hold: settles", "s", kSettles_s},
                           {"hold: periods_before_and_last", "", kPeriods},
                           {"hold: the_same_with_outages", "", kPeriodsOfOutages},
                           {"hold: wall_puts_in", "J", wall_work_joule()},
                           {"hold: may_grow_by", "", kGrowsTo_ratio - 1},
                           {"hold: and_by", "m", kGrows_m}});
}

}  // namespace thimble::lab
