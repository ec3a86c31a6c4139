#include "lab/compare/judged.hpp"

#include <algorithm>
#include <cmath>

#include "lab/trial/declared_energy.hpp"

namespace thimble::lab {
namespace {

constexpr double kTick_s = 1e-3;

double length(const auto& vector) { return norm(vector.x, vector.y, vector.z); }

// What the undelayed wall adds to a rise, K·v·Ts + B·v, for a hand that is faster than that one.
double fast_newton(double speed_m_per_s) {
  const coupling::GhostPointSettings wall;
  return (wall.stiffness.newton_per_m * kTick_s + wall.damping.newton_s_per_m) *
         std::max(0.0, speed_m_per_s - kHandOfRise_m_per_s);
}

// std::max() forgets what is not a number.
void keep_worst(double value, double& in) {
  if (std::isnan(value) || value > in) in = value;
}

double declared_for(const CouplingCase& of, const std::vector<Felt>& history) {
  double contacts = 0;
  double most_m = 0;
  bool was_in_contact = false;
  for (const Felt& felt : history) {
    if (felt.is_in_contact && !was_in_contact) contacts += 1;
    was_in_contact = felt.is_in_contact;
    most_m = std::max(most_m, length(felt.offset));
  }
  return declared_joule(of, contacts, most_m);
}

}  // namespace

void judge_forces(const std::vector<Felt>& history, Measures& into) {
  for (const Felt& felt : history) keep_worst(length(felt.force), into.most_newton);
  judge_changes(history, into);
}

void judge_changes(const std::vector<Felt>& history, Measures& into) {
  Felt before{};
  for (const Felt& felt : history) {
    if (felt.is_in_contact) keep_worst(felt.force.x, into.most_pull_newton);
    const bool rises = !(length(felt.force) <= length(before.force));
    const bool has_jerked = length(felt.velocity - before.velocity) > kJerk_m_per_s;
    const double rise_newton = rises && !has_jerked ? length(felt.force - before.force) : 0;
    keep_worst(rise_newton, into.most_rise_newton);
    keep_worst(rise_newton - fast_newton(length(felt.velocity)), into.most_jump_newton);
    before = felt;
  }
}

void judge_energy(const CouplingCase& of, const std::vector<Felt>& history, const Finger& finger,
                  Measures& into) {
  const double declared = declared_for(of, history);
  const double generated = finger.energy().generated_joule();
  const bool is_first = !(into.declared_joule > 0);
  if (!is_first && generated * into.declared_joule <= into.generated_joule * declared) return;
  into.generated_joule = generated;
  into.declared_joule = declared;
}

}  // namespace thimble::lab
