#include "lab/hello_sphere/touch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/world/sphere_world.hpp"
#include "lab/trial/finger.hpp"
#include "lab/trial/spread.hpp"

namespace thimble::lab {
namespace {

// Ours.
constexpr double kAbove_m = 0.010;
constexpr double kBelow_m = 0.010;
constexpr double kPress_m_per_s = 0.1;
constexpr double kHeld_s = 3;
constexpr double kBeside_m = 0.030;
constexpr double kStroke_m_per_s = 0.05;
constexpr double kMeasured_s = 1;
constexpr double kSeen_m = 1e-5;  // a swing below that is none

double size_of(Force3 force) { return norm(force.x, force.y, force.z); }
double size_of(Displacement3 way) { return norm(way.x, way.y, way.z); }

Position3 start_of(Gesture gesture) {
  if (gesture == Gesture::Press) return {0, kBallTop_m + kAbove_m, 0};
  return {-kBeside_m, kBallTop_m - kBelow_m, 0};
}

double length_s(Gesture gesture) {
  if (gesture == Gesture::Press) return (kAbove_m + kBelow_m) / kPress_m_per_s + kHeld_s;
  return 2 * kBeside_m / kStroke_m_per_s;
}

FingerGoal goal_of(Gesture gesture, double now_s) {
  FingerGoal goal{.at = start_of(gesture)};
  if (gesture == Gesture::Stroke) {
    goal.at.x += kStroke_m_per_s * now_s;
    goal.moving.x = kStroke_m_per_s;
    return goal;
  }
  const double gone_m = std::min(kPress_m_per_s * now_s, kAbove_m + kBelow_m);
  goal.at.y -= gone_m;
  if (gone_m < kAbove_m + kBelow_m) goal.moving.y = -kPress_m_per_s;
  return goal;
}

}  // namespace

Result<Touch> touch_ball(const CouplingCase& of, Gesture gesture, double delay_s) {
  auto world = world::SphereWorld::create(
      {.center = {0, kBallCenter_m, 0}, .radius_m = kBall_m, .floor_m = kFloor_m});
  if (!world) return tl::unexpected(world.error());
  auto loop = make_trial(of, *world, {.impairment = {.delay_s = delay_s}});
  if (!loop) return tl::unexpected(loop.error());
  const Position3 start = start_of(gesture);
  const double rest_s = 0.2 + 3 * delay_s;
  while (seconds((*loop)->now().since_epoch) < rest_s) (void)(*loop)->tick(start, {});
  Finger finger(start, (*loop)->dt());
  Touch touch;
  const auto ticks = std::lround(length_s(gesture) / seconds((*loop)->dt()));
  for (long tick = 1; tick <= ticks; ++tick) {
    const double now_s = static_cast<double>(tick) * seconds((*loop)->dt());
    const coupling::ArmOutput felt = (*loop)->tick(finger.tip(), finger.seen_velocity());
    touch.ticks.push_back(
        {.now_s = now_s, .tip = finger.tip(), .force = felt.force, .offset = felt.offset});
    finger.move(goal_of(gesture, now_s), felt.force);
  }
  touch.generated_joule = finger.energy().generated_joule();
  return touch;
}

Held held(const Touch& press) {
  std::array<Spread, 3> places;
  Spread force;
  Held found;
  const double from_s = press.ticks.back().now_s - kMeasured_s;
  for (const TouchTick& tick : press.ticks) {
    if (tick.now_s <= from_s) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) places[axis].add(tick.tip[axis]);
    force.add(size_of(tick.force));
  }
  for (const Spread& place : places) {
    found.swing_m = std::max(found.swing_m, place.most() - place.least());
  }
  found.mean_newton = force.mean();
  found.most_newton = force.most();
  found.offset_m = size_of(press.ticks.back().offset);
  if (places[1].most() - places[1].least() < kSeen_m) return found;
  int rises = 0;
  bool was_below = false;
  for (const TouchTick& tick : press.ticks) {
    if (tick.now_s <= from_s) continue;
    const bool is_below = tick.tip.y < places[1].mean();
    if (was_below && !is_below) ++rises;
    was_below = is_below;
  }
  found.swing_hz = rises / kMeasured_s;
  return found;
}

double distance_m(const Touch& a, const Touch& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.ticks.size(); ++i) {
    const Displacement3 apart = a.ticks[i].tip - b.ticks[i].tip;
    squares += dot(apart, apart);
  }
  return std::sqrt(squares / static_cast<double>(a.ticks.size()));
}

std::vector<Parameter> touch_parameters() {
  return {{"press: above_top", "m", kAbove_m},     {"press: below_top", "m", kBelow_m},
          {"press: speed", "m/s", kPress_m_per_s}, {"press: held_for", "s", kHeld_s},
          {"stroke: beside", "m", kBeside_m},      {"stroke: speed", "m/s", kStroke_m_per_s}};
}

}  // namespace thimble::lab
