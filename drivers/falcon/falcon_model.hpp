#pragma once

#include <array>
#include <string_view>

namespace thimble::falcon {

// The arm as a table row: falcon_models.toml holds the values and says for each where it comes
// from; falcon_models.hpp is compiled from it. Letters are those of R. E. Stamper's report and of
// the facts sheet, section 1.7. Index 0, 1, 2 are the legs: top, right, left.
//
// Device frame: x right, y up, z out of the device towards the person; the axes of the base frame,
// whose origin is origin_m. A leg's own frame is that one turned about z by its azimuth, with its
// origin (on the axis of its crank) at (base_radius_m, base_shift_m, 0): u outwards, w = z.
//
//   u = a cos(theta1) - c + (d + e + b sin(theta3)) cos(theta2)
//   v = b cos(theta3) - f
//   w = a sin(theta1)     + (d + e + b sin(theta3)) sin(theta2)
//
// A value: any thread. The rows live as long as the program.
struct FalconModel {
  std::string_view name;  // as in the configuration and in "sim:NAME"
  std::string_view description;
  std::array<double, 3> leg_azimuth_rad{};
  double base_radius_m{};                   // r
  double base_shift_m{};                    // s
  double crank_m{};                         // a: from the axis of the motor's drum to the knee
  double rods_m{};                          // b: length of the parallelogram
  double grip_radius_m{};                   // c
  double knee_m{};                          // d: from the knee to the parallelogram
  double ankle_m{};                         // e: from the parallelogram to the grip
  double grip_shift_m{};                    // f
  double counts_per_motor_rev{};            // quadrupled
  double capstan_diameter_m{};              // of the motor's shaft
  double drum_diameter_m{};                 // of the crank
  double home_angle_rad{};                  // theta1 where its encoder, homed, says 0
  std::array<double, 3> motor_direction{};  // +1: a positive command drives theta1 up; or -1
  std::array<double, 3> crank_min_rad{};    // theta1 at the stops
  std::array<double, 3> crank_max_rad{};
  double motor_speed_limit_rad_per_s{};  // no faster change of an encoder is real
  std::array<double, 3> origin_m{};      // of the base frame, in the device frame
  double workspace_radius_m{};           // sphere about the origin, free of singularities
  // Of the tip along z at the origin, when all three motors are told one count more. It is not
  // known: see the table.
  double newton_per_count{};
  double least_newton_per_count{};  // no measured value is below it
  double peak_force_newton{};
  double continuous_force_newton{};
  double continuous_share{};            // of the largest command, which a motor bears for ever
  double max_stiffness_newton_per_m{};  // at 1 kHz
};

// Ticks of the servo a second from which on no sample is left out (decision 0259): the tick that
// sees an answer asks for the next, and at this rate it does so early enough to fall into step with
// the bridge's latency timer. Counted: FalconAtEachRate.
inline constexpr double kFullRate_hz = 4000;

}  // namespace thimble::falcon
