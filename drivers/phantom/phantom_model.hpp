#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace thimble::phantom {

// One arm of the family: what its maker or builder decided, as a table row. Index 0, 1, 2 are
// the bodies a (waist), b (upper arm), c (forearm) of the sheet. phantom_models.toml holds the
// values and says for each where it comes from; phantom_models.hpp is compiled from it.
//
// Angles and lengths are in the device frame of the sheet: x towards the person, y to the
// person's right, z up, origin on the waist axis at the foot of link a.
//
// A value: any thread. The rows live as long as the program.
struct PhantomModel {
  std::string_view name;  // as in the configuration and in "sim:NAME"
  std::string_view description;
  std::string_view home_pose;  // how a person holds the arm while calibrating, after "in "
  std::array<double, 3> link_m{};
  std::array<double, 3> capstan_diameter_m{};
  std::array<double, 3> drum_diameter_m{};
  std::array<double, 3> origin_m{};                        // of the base frame, in the device frame
  std::array<double, 3> motor_direction{};                 // s of the sheet: +1 or -1
  std::array<double, 3> counts_per_motor_rev{};            // quadrupled
  std::array<double, 3> torque_constant_newton_m_per_a{};  // newton metre per ampere
  std::array<double, 3> gimbal_counts_per_rev{};           // d, e, f; all 0: has no gimbal
  std::array<double, 3> home_angle_rad{};                  // body angles in the home pose
  std::array<double, 3> joint_min_rad{};                   // body angles at the stops
  std::array<double, 3> joint_max_rad{};                   // body angles at the stops
  std::array<double, 3> peak_current_a{};                  // per motor
  std::array<double, 3> continuous_current_a{};            // per motor
  double motor_speed_limit_rad_per_s{};                    // no faster change of a counter is real
  double workspace_radius_m{};          // sphere about the origin, free of singularities
  double peak_force_newton{};           // at the tip, near the origin
  double continuous_force_newton{};     // at the tip, near the origin
  double max_stiffness_newton_per_m{};  // at 1 kHz
};

}  // namespace thimble::phantom
