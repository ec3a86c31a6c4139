#include "daemon/coupling/spring_damper_arm.hpp"

#include <algorithm>
#include <chrono>

namespace thimble::coupling {
namespace {

constexpr double kMargin = 1.05;  // teleop.md 3
// The master's own steps: its grip stays stable at the slowest servo.
constexpr Duration kLongestStep = std::chrono::microseconds(500);
constexpr Duration kShortestStep = std::chrono::microseconds(10);
// Of its velocity that dampers take in one of them: below 2, or they throw a light one.
constexpr double kLargestShare = 0.5;

}  // namespace

SpringDamperArm::SpringDamperArm(const SpringDamperSettings& settings) noexcept
    : settings_(settings), tool_(settings.tool), port_(settings.age) {
  if (settings_.master_mass_kg > 0) {
    settings_.master_mass_kg =
        std::max(settings_.master_mass_kg, SpringDamperSettings::kLightestMaster_kg);
  }
}

void SpringDamperArm::restart(MonotonicTime now, Position3 tip) noexcept {
  port_.reset(now, tip);
  tool_ = settings_.tool;
  has_far_ = false;
  is_told_of_arm_ = false;
  master_ = {is_finite(tip) ? tip : Position3{}, {}};
}

void SpringDamperArm::begin_epoch(const ArmInput& input) noexcept {
  has_far_ = false;
  master_ = {input.tip, input.tip_velocity};
  // What one peer needed says nothing of the next; the force rises from nothing.
  if (is_told_of_arm_) tool_ = settings_.tool;
}

ArmOutput SpringDamperArm::advance(const ArmInput& input) noexcept {
  if (!is_finite(input.tip) || !is_finite(input.tip_velocity)) return port_.refuse(input);
  const FarEnd* const far = port_.listen(input);
  if (port_.is_new_epoch()) begin_epoch(input);
  if (far != nullptr) {
    // For the whole epoch: what the force is made of does not change under the hand.
    if (!has_far_) is_told_of_arm_ = far->is_arm && !settings_.is_between_arms;
    far_ = *far;
    has_far_ = true;
  }
  soften(input.link.round_trip);

  Force3 wish{};
  if (settings_.master_mass_kg > 0) {
    wish = move_master(input);
  } else {
    master_ = {input.tip, input.tip_velocity};
    wish = pull(master_);
  }
  ArmOutput output = port_.show(input, wish, has_far_ && far_.is_pressing, tool_);
  output.sample.hand = master_.at;
  output.sample.velocity = master_.velocity;
  if (has_far_) output.sample.pull = tool_.stiffness * (far_.slave - master_.at);
  return output;
}

void SpringDamperArm::soften(Duration round_trip) noexcept {
  if (!settings_.softens_with_delay) return;
  double damping = tool_.damping.newton_s_per_m;
  if (is_between_arms()) {
    const double theirs = has_far_ ? far_.tool.stiffness.newton_per_m : 0;
    if (!(theirs > 0)) return;  // no spring at the other end: there is no loop with delay in it
    tool_.stiffness.newton_per_m = std::min(tool_.stiffness.newton_per_m, theirs);
    const double their_damping = far_.tool.damping.newton_s_per_m;
    if (is_told_of_arm_ && their_damping > 0) damping = std::min(damping, their_damping);
  }
  if (round_trip <= Duration::zero()) return;
  const bool is_half = settings_.force_at == ForceAt::Both && !is_between_arms();
  const double reach_s = seconds(round_trip) * (is_half ? 0.5 : 1.0);
  const double most = damping / (kMargin * reach_s);
  tool_.stiffness.newton_per_m = std::min(tool_.stiffness.newton_per_m, most);
}

// On the master; nothing while the far end is unknown.
Force3 SpringDamperArm::pull(const Motion& master) const noexcept {
  if (!has_far_) return {};
  const Force3 drag = tool_.damping * master.velocity;
  if (settings_.force_at == ForceAt::World && !is_told_of_arm_) return far_.force - drag;
  return tool_.stiffness * (far_.slave - master.at) - drag;
}

// Returns what the hand feels of it.
Force3 SpringDamperArm::move_master(const ArmInput& input) noexcept {
  const double drag = tool_.damping.newton_s_per_m + settings_.grip.damping.newton_s_per_m;
  const double longest_s = kLargestShare * settings_.master_mass_kg / std::max(drag, 1.0);
  const Duration longest = std::clamp(from_seconds(longest_s), kShortestStep, kLongestStep);
  const auto steps = (input.dt + longest - Duration(1)) / longest;
  const double step_s = seconds(input.dt) / static_cast<double>(steps);
  Force3 grip{};
  for (auto i = steps; i > 0; --i) {
    grip = settings_.grip.stiffness * (input.tip - master_.at) +
           settings_.grip.damping * (input.tip_velocity - master_.velocity);
    const Force3 force = pull(master_) + grip;
    const double share = step_s / settings_.master_mass_kg;
    master_.velocity += {share * force.x, share * force.y, share * force.z};
    const Velocity3& v = master_.velocity;
    master_.at = master_.at + Displacement3{step_s * v.x, step_s * v.y, step_s * v.z};
  }
  return -grip;
}

}  // namespace thimble::coupling
