#include "drivers/falcon/falcon_kinematics.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "hal/base/check.hpp"

namespace thimble::falcon {
namespace {

// All ours. From the middle of the workspace Newton takes five steps to anywhere in it; four times
// as many bound the tick.
constexpr int kMaxSteps = 20;
constexpr double kFound_m = 1e-10;        // what legs may miss: far below an encoder's count
constexpr double kFarthestStep_m = 0.03;  // less than a rod: no step leaves for another pose
// The same pose found by the two ways; where a leg is nearly straight its angle hardly tells.
constexpr double kSameAngle_rad = 1e-6;
constexpr double kSameStretched_rad = 0.05;
constexpr double kStretchedSine = 0.1;  // sin(6 degrees)
constexpr double kFlatVolume = 0.05;    // of the three directions of the rods; 1: at right angles

double volume(const Matrix3& m) noexcept {
  const auto& [a, b, c] = m.row;
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// Nothing when the rows lie in a plane, or nearly so.
std::optional<Matrix3> inverted(const Matrix3& m) noexcept {
  const double determinant = volume(m);
  if (!(std::abs(determinant) >= kFlatVolume)) return std::nullopt;  // also NaN
  Matrix3 out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const auto& p = m.row[(j + 1) % 3];
      const auto& q = m.row[(j + 2) % 3];
      out.row[i][j] =
          (p[(i + 1) % 3] * q[(i + 2) % 3] - p[(i + 2) % 3] * q[(i + 1) % 3]) / determinant;
    }
  }
  return out;
}

}  // namespace

std::string_view to_string(PoseTrouble trouble) noexcept {
  switch (trouble) {
    case PoseTrouble::None:
      return "none";
    case PoseTrouble::OutOfReach:
      return "unreachable";
    case PoseTrouble::Singular:
      return "singular";
    case PoseTrouble::NotFound:
      return "not found";
  }
  return "unknown";
}

FalconKinematics::FalconKinematics(const FalconModel& model, double newton_per_count)
    : model_(model),
      rad_per_count_(2 * std::numbers::pi / model.counts_per_motor_rev * model.capstan_diameter_m /
                     model.drum_diameter_m) {
  THIMBLE_CHECK(newton_per_count > 0);
  for (std::size_t leg = 0; leg < 3; ++leg) {
    azimuth_cosine_[leg] = std::cos(model.leg_azimuth_rad[leg]);
    azimuth_sine_[leg] = std::sin(model.leg_azimuth_rad[leg]);
  }
  // At the origin all legs stand alike, so one count more of each is the force along z that the
  // torque of one count holds.
  ArmPose middle;
  if (inverse({}, middle.crank_rad) != PoseTrouble::None || !take_jacobian(middle)) return;
  newton_m_per_count_ = newton_per_count * middle.jacobian_m_per_rad.row[2][0];
}

CrankAngles FalconKinematics::crank_angles(
    const std::array<std::int16_t, 3>& counts) const noexcept {
  CrankAngles crank_rad{};
  for (std::size_t leg = 0; leg < 3; ++leg) {
    crank_rad[leg] = model_.home_angle_rad + rad_per_count_ * counts[leg];
  }
  return crank_rad;
}

bool FalconKinematics::is_beyond_stops(const CrankAngles& crank_rad,
                                       double slack_rad) const noexcept {
  for (std::size_t leg = 0; leg < 3; ++leg) {
    // Written so that NaN is beyond.
    if (!(crank_rad[leg] >= model_.crank_min_rad[leg] - slack_rad)) return true;
    if (!(crank_rad[leg] <= model_.crank_max_rad[leg] + slack_rad)) return true;
  }
  return false;
}

FalconKinematics::LegPoint FalconKinematics::leg_point(std::size_t leg,
                                                       Position3 tip) const noexcept {
  const double x_m = tip.x + model_.origin_m[0];
  const double y_m = tip.y + model_.origin_m[1];
  const double cosine = azimuth_cosine_[leg];
  const double sine = azimuth_sine_[leg];
  return {.out_m = cosine * x_m + sine * y_m - model_.base_radius_m + model_.grip_radius_m,
          .across_m = -sine * x_m + cosine * y_m - model_.base_shift_m + model_.grip_shift_m,
          .up_m = tip.z + model_.origin_m[2]};
}

double FalconKinematics::rods_seen_m(const LegPoint& point) const noexcept {
  const double rods_m = model_.rods_m;
  const double seen_squared_m2 = rods_m * rods_m - point.across_m * point.across_m;
  return model_.knee_m + model_.ankle_m + std::sqrt(seen_squared_m2);
}

PoseTrouble FalconKinematics::crank_angle(const LegPoint& point, double& out_rad) const noexcept {
  constexpr double kRounding = 1e-9;
  const double rods_m = rods_seen_m(point);
  const double crank_m = model_.crank_m;
  const double distance_m = std::hypot(point.out_m, point.up_m);
  const double cosine =
      (crank_m * crank_m + distance_m * distance_m - rods_m * rods_m) / (2 * crank_m * distance_m);
  if (!(std::abs(cosine) <= 1 + kRounding)) return PoseTrouble::OutOfReach;  // also NaN
  const double opening_rad = std::acos(std::fmin(1, std::fmax(-1, cosine)));
  out_rad = std::atan2(point.up_m, point.out_m) - opening_rad;
  return PoseTrouble::None;
}

FalconKinematics::LegGap FalconKinematics::leg_gap(std::size_t leg, double crank_rad,
                                                   Position3 tip) const noexcept {
  const LegPoint point = leg_point(leg, tip);
  const double rods_m = rods_seen_m(point);
  const double cosine = std::cos(crank_rad);
  const double sine = std::sin(crank_rad);
  const double knee_out_m = point.out_m - model_.crank_m * cosine;
  const double knee_up_m = point.up_m - model_.crank_m * sine;
  const double along_rods_m = rods_m - model_.knee_m - model_.ankle_m;
  // Half the difference of the squares over the length, and its derivatives.
  LegGap gap;
  gap.gap_m = (knee_out_m * knee_out_m + knee_up_m * knee_up_m - rods_m * rods_m) / (2 * rods_m);
  const double per_out = knee_out_m / rods_m;
  const double per_across = point.across_m / along_rods_m;
  gap.per_tip = {azimuth_cosine_[leg] * per_out - azimuth_sine_[leg] * per_across,
                 azimuth_sine_[leg] * per_out + azimuth_cosine_[leg] * per_across,
                 knee_up_m / rods_m};
  gap.per_crank_m_per_rad = model_.crank_m * (knee_out_m * sine - knee_up_m * cosine) / rods_m;
  return gap;
}

PoseTrouble FalconKinematics::inverse(Position3 tip, CrankAngles& out) const noexcept {
  if (!is_finite(tip)) return PoseTrouble::OutOfReach;
  CrankAngles crank_rad{};
  Matrix3 rods;
  bool is_stretched = false;
  for (std::size_t leg = 0; leg < 3; ++leg) {
    const PoseTrouble trouble = crank_angle(leg_point(leg, tip), crank_rad[leg]);
    if (trouble != PoseTrouble::None) return trouble;
    const LegGap gap = leg_gap(leg, crank_rad[leg], tip);
    rods.row[leg] = gap.per_tip;
    const double knee_sine = gap.per_crank_m_per_rad / model_.crank_m;
    is_stretched = is_stretched || !(std::abs(knee_sine) >= kStretchedSine);
  }
  if (is_beyond_stops(crank_rad, 0)) return PoseTrouble::OutOfReach;
  if (is_stretched || !inverted(rods)) return PoseTrouble::Singular;
  out = crank_rad;
  return PoseTrouble::None;
}

PoseTrouble FalconKinematics::forward(const CrankAngles& crank_rad, Position3 near,
                                      ArmPose& out) const noexcept {
  ArmPose pose;
  pose.crank_rad = crank_rad;
  pose.tip = near;
  double gap_m = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    Matrix3 rods;
    std::array<double, 3> gaps_m{};
    for (std::size_t leg = 0; leg < 3; ++leg) {
      const LegGap gap = leg_gap(leg, crank_rad[leg], pose.tip);
      rods.row[leg] = gap.per_tip;
      gaps_m[leg] = gap.gap_m;
    }
    gap_m = norm(gaps_m[0], gaps_m[1], gaps_m[2]);
    if (gap_m <= kFound_m) break;
    const auto solve = inverted(rods);
    if (!solve) return PoseTrouble::Singular;
    Displacement3 move;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& row = solve->row[axis];
      move[axis] = -(row[0] * gaps_m[0] + row[1] * gaps_m[1] + row[2] * gaps_m[2]);
    }
    const double length_m = norm(move);
    if (!std::isfinite(length_m)) return PoseTrouble::NotFound;
    if (length_m > kFarthestStep_m) move = (kFarthestStep_m / length_m) * move;
    pose.tip = pose.tip + move;
  }
  if (!(gap_m <= kFound_m) || !is_this_pose(crank_rad, pose.tip)) return PoseTrouble::NotFound;
  if (!take_jacobian(pose)) return PoseTrouble::Singular;
  out = pose;
  return PoseTrouble::None;
}

bool FalconKinematics::is_this_pose(const CrankAngles& crank_rad, Position3 tip) const noexcept {
  for (std::size_t leg = 0; leg < 3; ++leg) {
    double again_rad = 0;
    if (crank_angle(leg_point(leg, tip), again_rad) != PoseTrouble::None) return false;
    const double knee_sine = leg_gap(leg, crank_rad[leg], tip).per_crank_m_per_rad / model_.crank_m;
    const bool is_stretched = std::abs(knee_sine) < kStretchedSine;
    const double allowed_rad = is_stretched ? kSameStretched_rad : kSameAngle_rad;
    if (!(std::abs(again_rad - crank_rad[leg]) <= allowed_rad)) return false;
  }
  return true;
}

// The legs stay closed: rods · v + per_crank · rate = 0, so J = -rods⁻¹ · per_crank; and the torque
// that holds a force at the tip is Jᵀ · F.
bool FalconKinematics::take_jacobian(ArmPose& pose) const noexcept {
  Matrix3 rods;
  std::array<double, 3> per_crank_m_per_rad{};
  for (std::size_t leg = 0; leg < 3; ++leg) {
    const LegGap gap = leg_gap(leg, pose.crank_rad[leg], pose.tip);
    rods.row[leg] = gap.per_tip;
    per_crank_m_per_rad[leg] = gap.per_crank_m_per_rad;
  }
  const auto solve = inverted(rods);
  if (!solve) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t leg = 0; leg < 3; ++leg) {
      const double column = -solve->row[axis][leg] * per_crank_m_per_rad[leg];
      pose.jacobian_m_per_rad.row[axis][leg] = column;
      pose.command_per_force.row[leg][axis] =
          model_.motor_direction[leg] * column / newton_m_per_count_;
    }
  }
  return true;
}

}  // namespace thimble::falcon
