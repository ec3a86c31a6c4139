#include <algorithm>
#include <cmath>

#include "lab/compare/judged.hpp"
#include "lab/compare/scenarios.hpp"
#include "lab/trial/spread.hpp"

namespace thimble::lab {
namespace {

// SOURCE: teleop.md section 3.
constexpr double kStart_m = kWall_m - 0.030;
constexpr double kGoal_m = kWall_m + 0.020;
constexpr double kSpeed_m_per_s = 0.2;
constexpr double kArrived_s = (kGoal_m - kStart_m) / kSpeed_m_per_s;
constexpr double kLeave_s = kArrived_s + 3;
constexpr double kLeft_s = kLeave_s + (kGoal_m - kStart_m) / kSpeed_m_per_s;
constexpr double kEnd_s = kLeft_s + 1.25;
constexpr double kFree_m = kWall_m - 0.003;  // ours

double size_of(Force3 force) { return norm(force.x, force.y, force.z); }

FingerGoal goal_at(double now_s) {
  FingerGoal goal{.at = {kStart_m, kBeside_m, 0}};
  if (now_s < kLeave_s) {
    goal.at.x = std::min(kStart_m + kSpeed_m_per_s * now_s, kGoal_m);
    if (now_s < kArrived_s) goal.moving.x = kSpeed_m_per_s;
  } else {
    goal.at.x = std::max(kGoal_m - kSpeed_m_per_s * (now_s - kLeave_s), kStart_m);
    if (now_s < kLeft_s) goal.moving.x = -kSpeed_m_per_s;
  }
  return goal;
}

void judge_rest(const std::vector<Felt>& history, Measures& into) {
  Spread drag;
  Spread hold;
  Spread place;
  Spread residue;
  bool has_touched = false;
  for (const Felt& felt : history) {
    has_touched = has_touched || felt.tip.x >= kFree_m;
    if (!has_touched && felt.now_s > 0.05) drag.add(size_of(felt.force));
    if (felt.now_s > kLeave_s - 1 && felt.now_s <= kLeave_s) {
      hold.add(-felt.force.x);
      place.add(felt.tip.x);
    }
    if (felt.now_s > kEnd_s - 0.3) residue.add(size_of(felt.force));
  }
  into.drag_newton = drag.mean();
  into.hold_newton = hold.mean();
  into.swing_m = place.most() - place.least();
  into.residue_newton = residue.mean();
}

}  // namespace

Result<void> play_approach(const CouplingCase& of, const StageSettings& settings, Measures& into) {
  const Position3 start{kStart_m, kBeside_m, 0};
  auto stage = Stage::create(of, settings, start);
  if (!stage) return tl::unexpected(stage.error());
  Finger finger(start, (*stage)->dt());
  while ((*stage)->now_s() < kEnd_s) {
    const Felt& felt = (*stage)->tick(finger.tip(), finger.seen_velocity());
    finger.move(goal_at(felt.now_s), felt.force);
  }
  const std::vector<Felt>& history = (*stage)->history();
  judge_rest(history, into);
  judge_forces(history, into);
  judge_energy(of, history, finger, into);
  into.packets_per_s = (*stage)->packets_per_s();
  into.bytes_per_s = (*stage)->bytes_per_s();
  return {};
}

void list_approach(std::vector<Parameter>& into) {
  into.insert(into.end(), {{"approach: before_wall", "m", kWall_m - kStart_m},
                           {"approach: behind_wall", "m", kGoal_m - kWall_m},
                           {"approach: speed", "m/s", kSpeed_m_per_s},
                           {"approach: held_for", "s", kLeave_s - kArrived_s},
                           {"approach: free_before_wall", "m", kWall_m - kFree_m},
                           {"approach: ends_after_leaving", "s", kEnd_s - kLeft_s}});
}

}  // namespace thimble::lab
