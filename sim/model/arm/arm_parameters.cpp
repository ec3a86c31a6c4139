#include "sim/model/arm/arm_parameters.hpp"

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "drivers/phantom/phantom_models.hpp"

namespace thimble::sim {
namespace {

constexpr double degrees(double value) { return value * std::numbers::pi / 180; }

constexpr AngleRange range_degrees(double min, double max) { return {degrees(min), degrees(max)}; }

// What the table knows. `model` is one of its rows.
ArmParameters facts_of(const phantom::PhantomModel& model) {
  ArmParameters p;
  p.name = model.name;
  p.link_m = model.link_m;
  for (std::size_t i = 0; i < 3; ++i) {
    p.drive_ratio[i] = model.drum_diameter_m[i] / model.capstan_diameter_m[i];
  }
  p.motor_sign = model.motor_direction;
  p.torque_constant_newton_m_per_a = model.torque_constant_newton_m_per_a;
  p.counts_per_motor_turn = model.counts_per_motor_rev;
  p.origin_m = model.origin_m;
  p.home_rad = model.home_angle_rad;
  for (std::size_t i = 0; i < 3; ++i) {
    p.joint_range[i] = {model.joint_min_rad[i], model.joint_max_rad[i]};
  }
  return p;
}

// Only ever a constant expression: a row that leaves the table fails the build.
constexpr const phantom::PhantomModel& row(std::string_view name) {
  std::size_t i = 0;
  while (phantom::kPhantomModels[i].name != name) ++i;
  return phantom::kPhantomModels[i];
}

constexpr const phantom::PhantomModel& kVintage = row("phantom-vintage");
constexpr const phantom::PhantomModel& kWoody = row("woody-2015");

enum class Make : std::uint8_t { Vintage, Woody };

// Facts, and beside each other what nobody has weighed. The vintage arm's masses are chosen so that
// its tip weighs below 75 g in every direction of the home pose.
ArmParameters parameters_of(Make make) {
  const auto of = [make](const auto& vintage, const auto& woody) {
    return make == Make::Vintage ? vintage : woody;
  };
  ArmParameters p = facts_of(of(kVintage, kWoody));
  p.upper_arm_kg = of(0.020, 0.060);
  p.forearm_kg = of(0.012, 0.050);
  p.tip_kg = of(0.020, 0.025);
  p.turret_kg_m2 = of(2e-4, 2e-3);
  p.rotor_kg_m2.fill(of(1.03e-6, 3.33e-6));
  p.balance = of(1.0, 0.8);
  p.counterweight_radius_m = of(0.05, 0.07);
  p.backdrive_newton = of(0.04, 0.10);
  p.viscous_newton_s_per_m = of(0.05, 0.1);
  p.elbow_range = of(range_degrees(25, 155), range_degrees(20, 160));
  p.parked_rad = {degrees(of(12, -8)), degrees(of(60, 12)), degrees(of(10, 75))};
  return p;
}

}  // namespace

ArmParameters phantom_vintage_parameters() { return parameters_of(Make::Vintage); }
ArmParameters woody_2015_parameters() { return parameters_of(Make::Woody); }

}  // namespace thimble::sim
