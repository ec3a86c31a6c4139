#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>

#include "gantry_parts.hpp"
#include "gantry_wire.hpp"

namespace gantry {
namespace {

constexpr double kTurn_rad = 6.283185307179586;
// A reference that was forgotten on one side must be forgotten on the other: the arm is told with
// every report until it says so.
struct Device {
  bool wants_forget = true;
  bool is_referenced = false;
};

void say(const char* text, thimble_reason* reason) {
  std::snprintf(reason->text, sizeof(reason->text), "%s", text);
}

std::int32_t match(const thimble_hid_info* info, const thimble_driver_settings* settings,
                   thimble_reason* reason) {
  if (info->vendor_id != kVendorId || info->product_id != kProductId ||
      info->input_report_bytes != kInputBytes || info->output_report_bytes != kOutputBytes) {
    return THIMBLE_NOT_MINE;
  }
  if (settings->model[0] != '\0' && std::strcmp(settings->model, "gantry") != 0) {
    say("the model is unknown; there is \"gantry\"", reason);
    return THIMBLE_REFUSED;
  }
  if (settings->amplifier_max_a != 0) {
    say("amplifier_max_a must not be set: this arm's amplifiers are known", reason);
    return THIMBLE_REFUSED;
  }
  return THIMBLE_OK;
}

std::int32_t open(const thimble_hid_info*, const thimble_driver_settings*,
                  thimble_capabilities* capabilities, void** device, thimble_reason* reason) {
  auto* made = new (std::nothrow) Device();
  if (made == nullptr) {
    say("out of memory", reason);
    return THIMBLE_REFUSED;
  }
  *device = made;
  capabilities->joint_count = kAxes;
  std::snprintf(capabilities->model, sizeof(capabilities->model), "gantry");
  std::snprintf(capabilities->calibration_instruction,
                sizeof(capabilities->calibration_instruction),
                "Hold the tip in the middle of the gantry and press the button on its frame");
  capabilities->peak_force_newton = 6;
  capabilities->continuous_force_newton = 3;
  capabilities->max_stiffness_newton_per_m = 1000;
  capabilities->workspace_radius_m = kHalfTravel_m;
  for (int i = 0; i < kAxes; ++i) {
    capabilities->peak_current_a[i] = kPeakCurrent_a;
    capabilities->continuous_current_a[i] = kContinuousCurrent_a;
  }
  capabilities->sample_period_ns = kFrame_ns;
  capabilities->device_watchdog_ns = kWatchdog_ns;
  return THIMBLE_OK;
}

void close(void* device) { delete static_cast<Device*>(device); }

void forget_calibration(void* device) {
  auto& self = *static_cast<Device*>(device);
  self.wants_forget = true;
  self.is_referenced = false;
}

std::int32_t counter_at(const std::uint8_t* bytes) {
  const std::uint32_t value =
      static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8U |
      static_cast<std::uint32_t>(bytes[2]) << 16U | static_cast<std::uint32_t>(bytes[3]) << 24U;
  std::int32_t out = 0;
  std::memcpy(&out, &value, sizeof(out));
  return out;
}

std::int32_t decode(void* device, const thimble_hid_report* report, thimble_sample* sample) {
  auto& self = *static_cast<Device*>(device);
  if (report->size != kInputBytes) return THIMBLE_PROTOCOL_ERROR;
  const std::uint8_t flags = report->bytes[12];
  if ((flags & ~(kFlagReferenced | kFlagStylusButton | kFlagMotorsOn)) != 0) {
    return THIMBLE_PROTOCOL_ERROR;
  }
  const bool is_referenced = (flags & kFlagReferenced) != 0;
  if (!is_referenced) self.wants_forget = false;
  self.is_referenced = is_referenced && !self.wants_forget;
  for (int i = 0; i < kAxes; ++i) {
    const double turned_rad = counter_at(report->bytes + 4 * i) * kTurn_rad / kCountsPerTurn;
    const double along_m = self.is_referenced ? turned_rad * kPulley_m : 0;
    if (std::abs(along_m) > kHalfTravel_m + 0.01) return THIMBLE_PROTOCOL_ERROR;
    sample->joint_position_rad[i] = turned_rad;
    sample->tip_m[kBaseAxis[i]] = kBaseSign[i] * along_m;
    sample->motor_current_a_per_newton[i][kBaseAxis[i]] =
        kBaseSign[i] * kPulley_m / kTorque_newton_m_per_a;
  }
  sample->buttons = (flags & kFlagStylusButton) != 0 ? 1 : 0;
  sample->calibration =
      self.is_referenced ? THIMBLE_CALIBRATION_DONE : THIMBLE_CALIBRATION_NEEDS_PERSON;
  return THIMBLE_OK;
}

std::int32_t encode(void* device, const thimble_wrench* wrench,
                    std::uint8_t bytes[THIMBLE_REPORT_BYTES]) {
  const auto& self = *static_cast<Device*>(device);
  std::uint8_t sum = 0;
  for (int i = 0; i < kAxes; ++i) {
    const double force_newton = kBaseSign[i] * wrench->force_newton[kBaseAxis[i]];
    const double wanted_a = force_newton * kPulley_m / kTorque_newton_m_per_a;
    const double current_a = std::clamp(wanted_a, -kPeakCurrent_a, kPeakCurrent_a);
    const auto milliampere = static_cast<std::int16_t>(std::lround(current_a * 1000));
    const auto raw = static_cast<std::uint16_t>(self.is_referenced ? milliampere : 0);
    bytes[2 * i] = static_cast<std::uint8_t>(raw & 0xffU);
    bytes[2 * i + 1] = static_cast<std::uint8_t>(raw >> 8U);
  }
  bytes[6] = self.wants_forget ? kCommandForget : kCommandDrive;
  for (int i = 0; i < 7; ++i) sum = static_cast<std::uint8_t>(sum + bytes[i]);
  bytes[7] = sum;
  return THIMBLE_OK;
}

}  // namespace

const thimble_driver kDriver = {
    sizeof(thimble_driver), 0,       "gantry", &match, &open, &close,
    &forget_calibration,    &decode, &encode,
};

}  // namespace gantry
