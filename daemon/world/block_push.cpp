#include "daemon/world/block_push.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::world {
namespace {

using Impulse3 = Vector3<struct ImpulseTag>;  // N·s

double share_of(const BlockOil& oil, double dt_s) noexcept {
  return 1 - std::exp(-oil.stiffness_newton_per_m * dt_s / oil.drag_newton_s_per_m);
}

// Moves the block across the face; the impulse of the hand, N·s.
double push_across(const BlockOil& oil, double weight_newton, double share, double dt_s,
                   BlockMotion& motion) noexcept {
  auto& [center, hold] = motion;
  const double k = oil.stiffness_newton_per_m;
  const double b = oil.drag_newton_s_per_m;
  const double away_newton = hold.sign * weight_newton;
  double held_s = dt_s;
  if (away_newton > 0) {
    held_s = std::min(dt_s, b / k * std::log1p(k * hold.depth_m / away_newton));
    share = share_of(oil, held_s);
  }
  const double held_m = (hold.depth_m + away_newton / k) * share;
  const double wanted_m = held_m + away_newton / b * (dt_s - held_s);
  const double before_m = center[hold.axis];
  const double there_m = before_m + hold.sign * wanted_m;
  center[hold.axis] = std::clamp(there_m, -oil.most_m, oil.most_m);
  hold.depth_m = std::max(0.0, hold.depth_m - hold.sign * (center[hold.axis] - before_m));
  // At the wall of the room it stands.
  if (center[hold.axis] != there_m) return k * hold.depth_m * dt_s;
  return std::max(0.0, b * held_m - away_newton * held_s);
}

// Moves it along the face; `most_newton_s`: what friction gives at most.
void drag_along(const BlockOil& oil, Force3 weight, double share, double dt_s, double most_newton_s,
                BlockMotion& motion) noexcept {
  auto& [center, hold] = motion;
  const double k = oil.stiffness_newton_per_m;
  const double b = oil.drag_newton_s_per_m;
  const Position3 before = center;
  Impulse3 stuck{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis == hold.axis) continue;
    const double wanted_m = (hold.stretch[axis] + weight[axis] / k) * share;
    const double there_m = before[axis] + wanted_m;
    center[axis] = std::clamp(there_m, -oil.most_m, oil.most_m);
    stuck[axis] = center[axis] != there_m
                      ? k * (hold.stretch[axis] - (center[axis] - before[axis])) * dt_s
                      : b * wanted_m - weight[axis] * dt_s;
  }
  const double size_newton_s = norm(stuck);
  const bool slips = size_newton_s > most_newton_s;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis == hold.axis) continue;
    if (slips) {
      const double given_newton_s = stuck[axis] * (most_newton_s / size_newton_s);
      const double wanted_m = (given_newton_s + weight[axis] * dt_s) / b;
      center[axis] = std::clamp(before[axis] + wanted_m, -oil.most_m, oil.most_m);
    }
    hold.stretch[axis] -= center[axis] - before[axis];
  }
}

}  // namespace

BlockMotion push_block(const BlockOil& oil, const BlockHold& hold, Position3 center, Force3 weight,
                       double dt_s) noexcept {
  const double share = share_of(oil, dt_s);
  BlockMotion motion{center, hold};
  const double push_newton_s = push_across(oil, weight[hold.axis], share, dt_s, motion);
  drag_along(oil, weight, share, dt_s, oil.friction * push_newton_s, motion);
  const double most_m = oil.friction * motion.hold.depth_m;
  const double stretch_m = norm(motion.hold.stretch);
  if (stretch_m > most_m) motion.hold.stretch = (most_m / stretch_m) * motion.hold.stretch;
  return motion;
}

Position3 sink_block(const BlockOil& oil, Position3 center, Force3 weight, double dt_s) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    center[axis] = std::clamp(center[axis] + weight[axis] * dt_s / oil.drag_newton_s_per_m,
                              -oil.most_m, oil.most_m);
  }
  return center;
}

}  // namespace thimble::world
