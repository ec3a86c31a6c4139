#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drivers/phantom/phantom_model.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/units.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::phantom {

// Angles of the bodies a, b, c in rad. a turns about the upright axis, positive to the right;
// b is the lean of the upper arm from upright towards the person; c the rise of the forearm
// from hanging down. Both b and c are absolute: a parallelogram drives the forearm.
using BodyAngles = std::array<double, 3>;

// Everything the servo wants of one pose. Base frame of Thimble: x right, y up, z towards the
// person, which are y, z, x of the sheet's device frame.
struct ArmPose {
  BodyAngles angle_rad{};
  Position3 tip{};
  Matrix3 jacobian_m_per_rad{};       // tip velocity = J · angle rates; row axis, column body
  Matrix3 motor_current_per_force{};  // A/N: I = M · F; row motor, column axis
  bool operator==(const ArmPose&) const = default;
};

// Geometry of the arm. Pure; finite for finite angles, in singular poses too: forces need the
// transposed Jacobian only, never its inverse.
// Thread: any. RT: all THIMBLE_RT.
// Source of the formulas: forsslund/haptikfabrikenapi at b8d6c944, src/kinematics.cpp
// (facts; the Jacobian is derived here and checked numerically).

// `counts` from the home pose on, unwrapped.
THIMBLE_RT [[nodiscard]] BodyAngles body_angles(
    const PhantomModel& model, const std::array<EncoderCounts, 3>& counts_from_home) noexcept;
// Angles of the gimbal's axes d, e, f in -π to π, 0 where the counters are 0. The 16-bit counters
// may wrap: a whole number of turns fits them for every gimbal of the table. 0 for an axis without
// encoder.
THIMBLE_RT [[nodiscard]] std::array<double, 3> gimbal_angle_rad(
    const PhantomModel& model, const std::array<std::int16_t, 3>& counts) noexcept;
THIMBLE_RT [[nodiscard]] ArmPose pose_at(const PhantomModel& model,
                                         const BodyAngles& angle_rad) noexcept;
// The tip cannot move in some direction, or nearly so: within 5 mm of the waist axis, or the
// links within 3 degrees of a straight line or of lying on each other. Bounds are ours.
THIMBLE_RT [[nodiscard]] bool is_singular(const PhantomModel& model,
                                          const BodyAngles& angle_rad) noexcept;
// The angles, elbow up and arm in front of the waist, that bring the tip there; nothing when
// it is out of reach or the pose would be singular.
THIMBLE_RT [[nodiscard]] std::optional<BodyAngles> inverse(const PhantomModel& model,
                                                           Position3 tip) noexcept;

}  // namespace thimble::phantom
