#include "sim/model/spacemouse/puck_model.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "drivers/spacemouse/spacemouse_wire.hpp"
#include "hal/bus/hid_report_descriptor.hpp"

namespace thimble::sim {
namespace {

namespace wire = spacemouse::wire;

void put(std::span<std::uint8_t> out, std::size_t at, std::int16_t value) noexcept {
  const auto bits = static_cast<std::uint16_t>(value);
  out[at] = static_cast<std::uint8_t>(bits % 256);
  out[at + 1] = static_cast<std::uint8_t>(bits / 256);
}

}  // namespace

PuckParameters combined_puck() { return {"SpaceMouse Compact", 0x256f, 0xc635, true, 350, 4}; }
PuckParameters separate_puck() { return {"SpaceNavigator", 0x046d, 0xc626, false, 400, 2}; }

bus::BusDeviceInfo PuckModel::describe() const {
  bus::BusDeviceInfo info;
  info.kind = bus::BusKind::Hid;
  info.vendor_id = parameters_.vendor_id;
  info.product_id = parameters_.product_id;
  info.manufacturer = "Thimble";
  info.product = "Simulated " + std::string(parameters_.name);
  info.input_report_bytes = parameters_.is_combined ? wire::kCombinedBytes : wire::kSeparateBytes;
  info.output_report_bytes = 2;  // the light's
  info.has_report_ids = true;
  return info;
}

// Plain bytes: what a real one says of its axes, by which a kernel makes a joystick of it, no
// driver of ours asks for.
std::vector<std::uint8_t> PuckModel::report_descriptor() const {
  const std::size_t axis_bytes =
      (parameters_.is_combined ? wire::kCombinedBytes : wire::kSeparateBytes) - 1;
  std::vector<bus::HidNumberedReport> reports{
      {wire::kTranslationReport, false, axis_bytes},
      {wire::kButtonReport, false, parameters_.button_bytes},
      {wire::kLightReport, true, 1}};
  if (!parameters_.is_combined) reports.push_back({wire::kRotationReport, false, axis_bytes});
  return bus::plain_report_descriptor(reports);
}

Duration PuckModel::frame_period() const noexcept { return wire::kReportPeriod; }

void PuckModel::step() noexcept {
  const Position3 tip = Position3{} + cap_;
  Force3 force = push_;
  is_held_pressed_ = load_ != nullptr && load_->is_button_pressed(time_);
  if (load_ != nullptr) {
    const Force3 held = load_->force_on_tip(time_, kSubstep, tip, velocity_);
    if (is_finite(held)) force += held;
  }
  // c dx/dt = F - k x, one implicit step: the same for any step, and never beyond the balance.
  const double dt_s = seconds(kSubstep);
  const double gain = dt_s / (kDamping_newton_s_per_m + dt_s * kSpring_newton_per_m);
  Displacement3 next = cap_;
  for (std::size_t i = 0; i < 3; ++i) {
    next[i] += gain * (force[i] - kSpring_newton_per_m * cap_[i]);
    next[i] = std::clamp(next[i], -kTravel_m, kTravel_m);
    velocity_[i] = (next[i] - cap_[i]) / dt_s;
  }
  cap_ = next;
  time_ = time_ + kSubstep;
}

void PuckModel::advance(MonotonicTime t) noexcept {
  if (!is_started_) {
    is_started_ = true;
    time_ = t;
  }
  while (time_ + kSubstep <= t) step();
}

void PuckModel::out_report(std::span<const std::uint8_t> bytes) noexcept {
  static_cast<void>(bytes);
}

std::int16_t PuckModel::counts(double share) const noexcept {
  const double most = parameters_.full_scale;
  return static_cast<std::int16_t>(std::lround(std::clamp(share, -1.0, 1.0) * most));
}

// The puck's own axes: right, towards the person, down.
std::array<std::int16_t, 6> PuckModel::axes() const noexcept {
  const auto& tilt = tilt_rad_;
  return {counts(cap_.x / kTravel_m),  counts(cap_.z / kTravel_m),  counts(-cap_.y / kTravel_m),
          counts(tilt[0] / kTilt_rad), counts(tilt[2] / kTilt_rad), counts(-tilt[1] / kTilt_rad)};
}

std::size_t PuckModel::say_buttons(std::span<std::uint8_t> out) noexcept {
  has_said_pressed_ = is_pressed_ || is_held_pressed_;
  out[0] = wire::kButtonReport;
  out[1] = has_said_pressed_ ? 1 : 0;
  for (std::size_t i = 1; i < parameters_.button_bytes; ++i) out[1 + i] = 0;
  return 1 + parameters_.button_bytes;
}

std::size_t PuckModel::in_report(std::span<std::uint8_t> out) noexcept {
  if ((is_pressed_ || is_held_pressed_) != has_said_pressed_) return say_buttons(out);
  const std::array<std::int16_t, 6> said = axes();
  const bool is_at_rest = said == std::array<std::int16_t, 6>{};
  // Of the separate layout each report says zero so often.
  const int zeros = parameters_.is_combined ? wire::kZeroReports : 2 * wire::kZeroReports;
  if (!is_at_rest) zeros_left_ = zeros;
  if (is_at_rest && zeros_left_-- <= 0) {
    zeros_left_ = 0;
    return 0;
  }
  const bool is_rotation = !parameters_.is_combined && is_rotation_next_;
  is_rotation_next_ = !is_rotation_next_;
  out[0] = is_rotation ? wire::kRotationReport : wire::kTranslationReport;
  const std::size_t count = parameters_.is_combined ? 6 : 3;
  for (std::size_t i = 0; i < count; ++i) put(out, 1 + 2 * i, said[is_rotation ? 3 + i : i]);
  return parameters_.is_combined ? wire::kCombinedBytes : wire::kSeparateBytes;
}

void PuckModel::power_cycle() noexcept {
  has_said_pressed_ = false;
  is_rotation_next_ = false;
  zeros_left_ = 0;
}

void PuckModel::push_tip(Force3 force) noexcept { push_ = is_finite(force) ? force : Force3{}; }

bool PuckModel::move_tip_to(Position3 tip) noexcept {
  const Displacement3 to = tip - Position3{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(std::abs(to[i]) <= kTravel_m)) return false;
  }
  cap_ = to;
  velocity_ = {};
  return true;
}

void PuckModel::turn_stylus(const std::array<double, 3>& angle_rad) noexcept {
  if (is_finite(angle_rad[0], angle_rad[1], angle_rad[2])) tilt_rad_ = angle_rad;
}

plugin::ArmTruth PuckModel::truth() const noexcept {
  plugin::ArmTruth truth;
  truth.tip = Position3{} + cap_;
  truth.tip_velocity = velocity_;
  return truth;
}

}  // namespace thimble::sim
