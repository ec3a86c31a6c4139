#pragma once

#include <array>

namespace thimble::sim {

// One value per leg: top, right, left. A crank's angle is theta1 of the facts sheet: 0 when it
// points outwards, growing towards the person.
using CrankVector = std::array<double, 3>;

// Everything that the simulated Falcon's mechanics and electronics need. "Fact" values come from
// the models table of drivers/falcon, "ours" are estimates whose reasons stand in README.md;
// nothing is asserted about a real arm from the latter.
struct FalconParameters {
  // Facts. Letters as in the sheet, section 1.7.
  CrankVector azimuth_rad{};
  double base_radius_m{};    // r
  double base_shift_m{};     // s
  double crank_m{};          // a
  double rods_m{};           // b
  double grip_radius_m{};    // c
  double rods_to_links_m{};  // d + e: what is added to the parallelogram's reach at its two ends
  double grip_shift_m{};     // f
  double drive_ratio{};      // drum / capstan
  double counts_per_rad{};   // of a crank
  double home_rad{};         // where a homed encoder reads 0
  CrankVector motor_sign{};  // of a crank's torque for a positive command
  CrankVector origin_m{};    // of the base frame in the device frame
  double largest_counts{};   // of a motor command

  // Ours: masses. Cranks and rods are uniform thin rods; half of the rods goes with either end.
  double crank_kg{0.030};
  double rods_kg{0.020};  // both of a leg
  double grip_kg{0.100};
  double rotor_kg_m2{4e-6};  // at the motor's shaft
  double gravity_m_per_s2{9.80665};

  // Ours: force of the tip along z at the origin when all three motors are told one count more.
  double newton_per_count{10.0 / 4095};

  // Ours: friction of a crank and the stops.
  double coulomb_newton_m{0.008};
  double viscous_newton_m_s_per_rad{0.001};
  double friction_knee_rad_per_s{0.05};  // half width of the smoothed sign()
  double crank_min_rad{-0.70};           // -40 degrees
  double crank_max_rad{1.48};            // 85 degrees
  double crank_stop_newton_m_per_rad{60};
  double rim_m{0.07};  // how far from the axis the shell lets the grip
  double rim_newton_per_m{8000};
  double stop_damping_s{2};  // Hunt-Crossley: the stop's push grows by this share per rad/s or m/s

  CrankVector parked_m{0, 0, 0.040};      // base frame: where the grip is when it is switched on
  CrankVector pulled_out_m{0, 0, 0.035};  // base frame: whence it is pushed in to be homed
  CrankVector pushed_in_m{0, 0, 0};
};

[[nodiscard]] FalconParameters falcon_parameters();

}  // namespace thimble::sim
