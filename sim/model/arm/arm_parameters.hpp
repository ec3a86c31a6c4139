#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace thimble::sim {

// One value per body angle: A turns the base about the vertical, B tilts the upper arm
// (absolute, 0 = straight up), C tilts the forearm (absolute, 0 = straight down).
using JointVector = std::array<double, 3>;

struct AngleRange {
  double min_rad{};
  double max_rad{};
};

// Everything that the simulated arm's mechanics and electronics need to know of one make.
// "Fact" values come from the fact sheet's models table, "ours" are estimates whose reasons
// stand in README.md; nothing is asserted about a real arm from the latter.
struct ArmParameters {
  std::string_view name;
  std::string_view description;

  // Facts.
  std::array<double, 3> link_m{};       // La (base height), Lb (upper arm), Lc (forearm)
  std::array<double, 3> drive_ratio{};  // drum / capstan: motor turns per body turn
  std::array<double, 3> motor_sign{};   // s of arms.md 3.1: body angle = s * motor angle / ratio
  std::array<double, 3> torque_constant_newton_m_per_a{};
  std::array<double, 3> counts_per_motor_turn{};
  std::array<double, 3> gimbal_counts_per_turn{};  // all 0: no gimbal
  bool is_teensy_board{false};       // 64-byte reports with the stylus button folded in; else 14
  std::array<double, 3> origin_m{};  // device frame: ox, oy, oz
  JointVector home_rad{};            // pose in which the arm is held for calibration

  // Ours: masses. Links are uniform thin rods, the stylus a point at the tip.
  double upper_arm_kg{};
  double forearm_kg{};
  double tip_kg{};
  double turret_kg_m2{};                // what turns with A only
  std::array<double, 3> rotor_kg_m2{};  // at the motor shaft
  double balance{};                     // share of the links' moment that counterweights cancel
  double counterweight_radius_m{};
  double gravity_m_per_s2{9.80665};

  // Ours: friction, and what the stops are like. Where they are is the table's.
  double backdrive_newton{};  // Coulomb friction of each joint, as felt at the tip on its lever at
                              // home
  double viscous_newton_s_per_m{};       // the same for viscous friction
  double friction_knee_rad_per_s{0.01};  // half width of the smoothed sign()
  std::array<AngleRange, 3> joint_range{};
  AngleRange elbow_range{};  // of B + C: the angle between the links; 0 and pi are singular
  double stop_newton_m_per_rad{60};
  double stop_damping_s_per_rad{2};  // Hunt-Crossley: torque grows by this share per rad/s

  JointVector parked_rad{};  // where the arm rests when it is switched on
};

// The rows of the models table that are simulated, with the estimates for each.
[[nodiscard]] ArmParameters phantom_vintage_parameters();
[[nodiscard]] ArmParameters woody_2015_parameters();
[[nodiscard]] ArmParameters premium_1_5_parameters();
[[nodiscard]] ArmParameters aluhaptics_2_parameters();
[[nodiscard]] ArmParameters polhem_1_parameters();
// All of them, in the order of the table.
[[nodiscard]] std::vector<ArmParameters> all_arm_parameters();

}  // namespace thimble::sim
