#include "drivers/phantom/phantom_kinematics.hpp"

#include <cmath>
#include <numbers>

namespace thimble::phantom {
namespace {

constexpr double kWaistClearance_m = 0.005;
constexpr double kElbowSine = 0.05;  // sin(3 degrees)

// Turns of a drum per turn of its motor.
double reduction(const PhantomModel& model, std::size_t joint) noexcept {
  return model.capstan_diameter_m[joint] / model.drum_diameter_m[joint];
}

// Distance of the tip from the waist axis; negative when the arm reaches over its head.
double reach_m(const PhantomModel& model, double sin_b, double sin_c) noexcept {
  return model.link_m[1] * sin_b + model.link_m[2] * sin_c;
}

}  // namespace

BodyAngles body_angles(const PhantomModel& model,
                       const std::array<EncoderCounts, 3>& counts_from_home) noexcept {
  BodyAngles angle_rad{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double motor_rad = 2 * std::numbers::pi * static_cast<double>(counts_from_home[i].value) /
                             model.counts_per_motor_rev[i];
    angle_rad[i] =
        model.home_angle_rad[i] + model.motor_direction[i] * motor_rad * reduction(model, i);
  }
  return angle_rad;
}

std::array<double, 3> gimbal_angle_rad(const PhantomModel& model,
                                       const std::array<std::int16_t, 3>& counts) noexcept {
  std::array<double, 3> angle_rad{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (model.gimbal_counts_per_rev[i] == 0) continue;
    const double turns = counts[i] / model.gimbal_counts_per_rev[i];
    angle_rad[i] = 2 * std::numbers::pi * std::remainder(turns, 1);
  }
  return angle_rad;
}

ArmPose pose_at(const PhantomModel& model, const BodyAngles& angle_rad) noexcept {
  const double sin_a = std::sin(angle_rad[0]), cos_a = std::cos(angle_rad[0]);
  const double sin_b = std::sin(angle_rad[1]), cos_b = std::cos(angle_rad[1]);
  const double sin_c = std::sin(angle_rad[2]), cos_c = std::cos(angle_rad[2]);
  const auto& [link_a_m, link_b_m, link_c_m] = model.link_m;
  const double r_m = reach_m(model, sin_b, sin_c);
  ArmPose pose;
  pose.angle_rad = angle_rad;
  pose.tip = {sin_a * r_m - model.origin_m[1],
              link_a_m + link_b_m * cos_b - link_c_m * cos_c - model.origin_m[2],
              cos_a * r_m - model.origin_m[0]};
  pose.jacobian_m_per_rad.row = {{
      {cos_a * r_m, sin_a * link_b_m * cos_b, sin_a * link_c_m * cos_c},
      {0, -link_b_m * sin_b, link_c_m * sin_c},
      {-sin_a * r_m, cos_a * link_b_m * cos_b, cos_a * link_c_m * cos_c},
  }};
  for (std::size_t joint = 0; joint < 3; ++joint) {
    const double current_per_torque = model.motor_direction[joint] * reduction(model, joint) /
                                      model.torque_constant_newton_m_per_a[joint];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      pose.motor_current_per_force.row[joint][axis] =
          current_per_torque * pose.jacobian_m_per_rad.row[axis][joint];
    }
  }
  return pose;
}

bool is_singular(const PhantomModel& model, const BodyAngles& angle_rad) noexcept {
  const double r_m = reach_m(model, std::sin(angle_rad[1]), std::sin(angle_rad[2]));
  const double elbow_sine = std::sin(angle_rad[1] + angle_rad[2]);
  // Written so that NaN counts as singular.
  return !(std::abs(r_m) >= kWaistClearance_m && std::abs(elbow_sine) >= kElbowSine);
}

std::optional<BodyAngles> inverse(const PhantomModel& model, Position3 tip) noexcept {
  if (!is_finite(tip)) return std::nullopt;
  const double x_device_m = tip.z + model.origin_m[0];
  const double y_device_m = tip.x + model.origin_m[1];
  const double above_shoulder_m = tip.y + model.origin_m[2] - model.link_m[0];
  const double r_m = std::hypot(x_device_m, y_device_m);
  const double distance_m = std::hypot(r_m, above_shoulder_m);
  const double upper_m = model.link_m[1];
  const double fore_m = model.link_m[2];
  const double between_cosine =
      (upper_m * upper_m + distance_m * distance_m - fore_m * fore_m) / (2 * upper_m * distance_m);
  if (!(std::abs(between_cosine) <= 1)) return std::nullopt;  // also for distance 0
  const double rise_rad = std::atan2(above_shoulder_m, r_m) + std::acos(between_cosine);
  const double b_rad = std::numbers::pi / 2 - rise_rad;
  const double c_rad =
      std::atan2(r_m - upper_m * std::sin(b_rad), upper_m * std::cos(b_rad) - above_shoulder_m);
  const BodyAngles angle_rad{std::atan2(y_device_m, x_device_m), b_rad, c_rad};
  if (is_singular(model, angle_rad)) return std::nullopt;
  return angle_rad;
}

}  // namespace thimble::phantom
