#include "sim/model/arm/arm_parameters.hpp"

#include <cstddef>
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
  p.description = model.description;
  p.link_m = model.link_m;
  for (std::size_t i = 0; i < 3; ++i) {
    p.drive_ratio[i] = model.drum_diameter_m[i] / model.capstan_diameter_m[i];
  }
  p.motor_sign = model.motor_direction;
  p.torque_constant_newton_m_per_a = model.torque_constant_newton_m_per_a;
  p.counts_per_motor_turn = model.counts_per_motor_rev;
  p.gimbal_counts_per_turn = model.gimbal_counts_per_rev;
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
constexpr const phantom::PhantomModel& kPremium = row("premium-1.5");
constexpr const phantom::PhantomModel& kAluhaptics = row("aluhaptics-2");
constexpr const phantom::PhantomModel& kPolhem = row("polhem-1");

// What nobody has weighed, but for the rotor of a known motor.
struct Estimates {
  double upper_arm_kg{};
  double forearm_kg{};
  double tip_kg{};
  double turret_kg_m2{};
  double rotor_kg_m2{};
  double balance{};
  double counterweight_radius_m{};
  double backdrive_newton{};
  double viscous_newton_s_per_m{};
  AngleRange elbow_range{};
  JointVector parked_rad{};
};

ArmParameters parameters_of(const phantom::PhantomModel& model, const Estimates& ours) {
  ArmParameters p = facts_of(model);
  p.upper_arm_kg = ours.upper_arm_kg;
  p.forearm_kg = ours.forearm_kg;
  p.tip_kg = ours.tip_kg;
  p.turret_kg_m2 = ours.turret_kg_m2;
  p.rotor_kg_m2.fill(ours.rotor_kg_m2);
  p.balance = ours.balance;
  p.counterweight_radius_m = ours.counterweight_radius_m;
  p.backdrive_newton = ours.backdrive_newton;
  p.viscous_newton_s_per_m = ours.viscous_newton_s_per_m;
  p.elbow_range = ours.elbow_range;
  p.parked_rad = ours.parked_rad;
  return p;
}

JointVector pose_degrees(double a, double b, double c) {
  return {degrees(a), degrees(b), degrees(c)};
}

}  // namespace

// The PHANToMs' masses are chosen so that the tip weighs below 75 g in every direction of the home
// pose.
ArmParameters phantom_vintage_parameters() {
  return parameters_of(kVintage, {.upper_arm_kg = 0.020,
                                  .forearm_kg = 0.012,
                                  .tip_kg = 0.020,
                                  .turret_kg_m2 = 2e-4,
                                  .rotor_kg_m2 = 1.03e-6,
                                  .balance = 1.0,
                                  .counterweight_radius_m = 0.05,
                                  .backdrive_newton = 0.04,
                                  .viscous_newton_s_per_m = 0.05,
                                  .elbow_range = range_degrees(25, 155),
                                  .parked_rad = pose_degrees(12, 60, 10)});
}

ArmParameters woody_2015_parameters() {
  return parameters_of(kWoody, {.upper_arm_kg = 0.060,
                                .forearm_kg = 0.050,
                                .tip_kg = 0.025,
                                .turret_kg_m2 = 2e-3,
                                .rotor_kg_m2 = 3.33e-6,
                                .balance = 0.8,
                                .counterweight_radius_m = 0.07,
                                .backdrive_newton = 0.10,
                                .viscous_newton_s_per_m = 0.1,
                                .elbow_range = range_degrees(20, 160),
                                .parked_rad = pose_degrees(-8, 12, 75)});
}

ArmParameters premium_1_5_parameters() {
  return parameters_of(kPremium, {.upper_arm_kg = 0.024,
                                  .forearm_kg = 0.014,
                                  .tip_kg = 0.018,
                                  .turret_kg_m2 = 3e-4,
                                  .rotor_kg_m2 = 1.03e-6,
                                  .balance = 1.0,
                                  .counterweight_radius_m = 0.05,
                                  .backdrive_newton = 0.04,
                                  .viscous_newton_s_per_m = 0.05,
                                  .elbow_range = range_degrees(20, 160),
                                  .parked_rad = pose_degrees(10, 75, 15)});
}

ArmParameters aluhaptics_2_parameters() {
  return parameters_of(kAluhaptics, {.upper_arm_kg = 0.040,
                                     .forearm_kg = 0.025,
                                     .tip_kg = 0.022,
                                     .turret_kg_m2 = 8e-4,
                                     .rotor_kg_m2 = 3.33e-6,
                                     .balance = 0.8,
                                     .counterweight_radius_m = 0.05,
                                     .backdrive_newton = 0.08,
                                     .viscous_newton_s_per_m = 0.08,
                                     .elbow_range = range_degrees(25, 155),
                                     .parked_rad = pose_degrees(9, 55, 18)});
}

ArmParameters polhem_1_parameters() {
  ArmParameters p = parameters_of(kPolhem, {.upper_arm_kg = 0.050,
                                            .forearm_kg = 0.035,
                                            .tip_kg = 0.045,  // with the gimbal
                                            .turret_kg_m2 = 1.5e-3,
                                            .rotor_kg_m2 = 6e-6,
                                            .balance = 0.8,
                                            .counterweight_radius_m = 0.06,
                                            .backdrive_newton = 0.10,
                                            .viscous_newton_s_per_m = 0.1,
                                            .elbow_range = range_degrees(20, 160),
                                            .parked_rad = pose_degrees(-7, 50, 24)});
  p.is_teensy_board = true;
  return p;
}

std::vector<ArmParameters> all_arm_parameters() {
  return {phantom_vintage_parameters(), woody_2015_parameters(), premium_1_5_parameters(),
          aluhaptics_2_parameters(), polhem_1_parameters()};
}

}  // namespace thimble::sim
