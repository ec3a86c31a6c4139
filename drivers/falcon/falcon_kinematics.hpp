#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/falcon/falcon_model.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::falcon {

// theta1 of the legs, rad: 0 is straight outwards, growing towards the person.
using CrankAngles = std::array<double, 3>;

// Everything the servo wants of one pose. Base frame: x right, y up, z towards the person.
struct ArmPose {
  CrankAngles crank_rad{};
  Position3 tip{};
  Matrix3 jacobian_m_per_rad{};  // tip velocity = J · crank rates; row axis, column leg
  Matrix3 command_per_force{};   // counts/N: command = M · F; row motor, column axis
  bool operator==(const ArmPose&) const = default;
};

// Why there is no pose.
enum class PoseTrouble : std::uint8_t {
  None,
  OutOfReach,  // a leg is too short for it, too long, or would have to pass a stop
  Singular,    // a leg is stretched, or the rods lie so flat that no motor holds the grip (below)
  NotFound,    // no grip joins legs that stand so: the encoders are wrong
};
[[nodiscard]] std::string_view to_string(PoseTrouble trouble) noexcept;

// Geometry of the arm, as falcon_model.hpp writes it. Pure; finite for finite input.
//
// Forces need the transposed Jacobian only: a stretched leg bounds commands as any other pose. Only
// where the rods lie flat it would grow without bound, and there forward() refuses.
//
// Bounds, all ours. Flat: a volume of the three directions of the rods below 0.05 (1: at right
// angles). Stretched: a knee within 6 degrees of straight, or of folded; only inverse() refuses it.
//
// Thread: any. RT: all THIMBLE_RT but the constructor. Ownership: `model` must outlive it; those of
// the table do.
// Source of the equations: R. E. Stamper, PhD report 97-4, University of Maryland, as the facts
// sheet gives them in 1.7; the Jacobian is derived here and checked numerically.
class FalconKinematics {
 public:
  // `newton_per_count`: as FalconModel's; > 0, else a broken invariant: forces divide by it.
  FalconKinematics(const FalconModel& model, double newton_per_count);

  // Counts as a homed arm says them.
  THIMBLE_RT [[nodiscard]] CrankAngles crank_angles(
      const std::array<std::int16_t, 3>& counts) const noexcept;
  // The angles that bring the tip there, knees outwards.
  THIMBLE_RT [[nodiscard]] PoseTrouble inverse(Position3 tip, CrankAngles& out) const noexcept;
  // Where the legs hold the tip: Newton's method from `near` on, until the legs miss it by 1e-10 m
  // or less, 20 steps at most; and the inverse as the check that it is this pose and not its mirror
  // image. `out` is untouched when there is trouble.
  THIMBLE_RT [[nodiscard]] PoseTrouble forward(const CrankAngles& crank_rad, Position3 near,
                                               ArmPose& out) const noexcept;
  // A crank beyond its stop by more than `slack_rad`.
  THIMBLE_RT [[nodiscard]] bool is_beyond_stops(const CrankAngles& crank_rad,
                                                double slack_rad) const noexcept;

 private:
  // A point in the own frame of a leg, from the axis of its crank.
  struct LegPoint {
    double out_m{};     // u + c
    double across_m{};  // v + f
    double up_m{};      // w
  };
  // What one leg says of a tip, its crank being given: how much too long it would be, and how that
  // changes.
  struct LegGap {
    double gap_m{};
    std::array<double, 3> per_tip{};  // dimensionless: about the direction of the rods
    double per_crank_m_per_rad{};
  };
  [[nodiscard]] LegPoint leg_point(std::size_t leg, Position3 tip) const noexcept;
  // The lower part of a leg, seen from the side; not a number where the grip is too far across.
  [[nodiscard]] double rods_seen_m(const LegPoint& point) const noexcept;
  [[nodiscard]] PoseTrouble crank_angle(const LegPoint& point, double& out_rad) const noexcept;
  [[nodiscard]] LegGap leg_gap(std::size_t leg, double crank_rad, Position3 tip) const noexcept;
  [[nodiscard]] bool is_this_pose(const CrankAngles& crank_rad, Position3 tip) const noexcept;
  [[nodiscard]] bool take_jacobian(ArmPose& pose) const noexcept;

  const FalconModel& model_;
  std::array<double, 3> azimuth_cosine_{};
  std::array<double, 3> azimuth_sine_{};
  double rad_per_count_{};
  double newton_m_per_count_{1};  // torque about a crank's axis
};

}  // namespace thimble::falcon
