#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <new>

#include "gantry_parts.hpp"
#include "gantry_wire.hpp"

// The simulated gantry: three carriages on belts, a board that counts and drives, and somebody who
// may hold the tip. Exact to a substep of 50 us: when the motors change, and the frames of the bus.
// Approximated: belts do not stretch, axes do not couple, friction is viscous, currents follow at
// once. Every figure is invented.
namespace gantry {
namespace {

constexpr std::int64_t kSubstep_ns = 50'000;
constexpr double kSubstep_s = 50e-6;
constexpr std::array<double, kAxes> kMass_kg = {0.09, 0.12, 0.06};  // carriages and rotors
constexpr double kFriction_newton_s_per_m = 0.3;
constexpr double kCountsPerM = kCountsPerTurn / (6.283185307179586 * kPulley_m);

using Axes = std::array<double, kAxes>;

struct Arm {
  Axes place_m{};  // along u, v, w
  Axes speed_m_per_s{};
  Axes current_a{};
  Axes zero_m{};  // where the counters are zero
  Axes push_newton{};
  std::int64_t now_ns = 0;    // of the bus
  std::int64_t plant_ns = 0;  // at most a substep behind
  std::int64_t heard_ns = 0;  // the last good report
  bool is_started = false;
  bool is_on = false;
  bool is_referenced = false;
  bool is_button_down = false;
  bool is_stylus_down = false;
  bool is_stylus_held = false;
  const thimble_tip_load* load = nullptr;
};

Arm& arm_of(void* device) { return *static_cast<Arm*>(device); }

void to_base(const Axes& axes, double base[3]) {
  for (std::size_t i = 0; i < kAxes; ++i) base[kBaseAxis[i]] = kBaseSign[i] * axes[i];
}

Axes from_base(const double base[3]) {
  Axes axes{};
  for (std::size_t i = 0; i < kAxes; ++i) axes[i] = kBaseSign[i] * base[kBaseAxis[i]];
  return axes;
}

Axes motor_force_newton(const Arm& arm) {
  Axes force{};
  for (std::size_t i = 0; i < kAxes; ++i) {
    force[i] = arm.current_a[i] * kTorque_newton_m_per_a / kPulley_m;
  }
  return force;
}

void switch_off(Arm& arm) {
  arm.is_on = false;
  arm.current_a = {};
}

Axes hand_force_newton(Arm& arm) {
  if (arm.load == nullptr) return {};
  double tip_m[3] = {};
  double velocity_m_per_s[3] = {};
  double force_newton[3] = {};
  to_base(arm.place_m, tip_m);
  to_base(arm.speed_m_per_s, velocity_m_per_s);
  arm.load->force_on_tip(arm.load->context, arm.plant_ns, kSubstep_ns, tip_m, velocity_m_per_s,
                         force_newton);
  arm.is_stylus_down =
      arm.is_stylus_held || arm.load->is_button_pressed(arm.load->context, arm.plant_ns) != 0;
  return from_base(force_newton);
}

void step(Arm& arm) {
  if (arm.is_on && arm.plant_ns - arm.heard_ns > kWatchdog_ns) switch_off(arm);
  const Axes motors = motor_force_newton(arm);
  const Axes hand = hand_force_newton(arm);
  for (std::size_t i = 0; i < kAxes; ++i) {
    const double force =
        motors[i] + hand[i] + arm.push_newton[i] - kFriction_newton_s_per_m * arm.speed_m_per_s[i];
    arm.speed_m_per_s[i] += force / kMass_kg[i] * kSubstep_s;
    arm.place_m[i] += arm.speed_m_per_s[i] * kSubstep_s;
    if (std::abs(arm.place_m[i]) <= kHalfTravel_m) continue;
    arm.place_m[i] = std::copysign(kHalfTravel_m, arm.place_m[i]);
    arm.speed_m_per_s[i] = 0;
  }
  // The board zeroes its counters for as long as the button is down.
  if (arm.is_button_down) {
    arm.zero_m = arm.place_m;
    arm.is_referenced = true;
  }
  arm.plant_ns += kSubstep_ns;
}

std::int32_t create(const thimble_model_settings* settings, thimble_model_facts* facts,
                    void** device, thimble_reason* reason) {
  if (settings->amplifier_max_a != 0) {
    std::strcpy(reason->text, "amplifier_max_a must not be set: this arm's amplifiers are known");
    return THIMBLE_REFUSED;
  }
  auto* arm = new (std::nothrow) Arm();
  if (arm == nullptr) {
    std::strcpy(reason->text, "out of memory");
    return THIMBLE_REFUSED;
  }
  arm->place_m = {-0.02, 0.03, -0.04};  // where it was left
  facts->frame_period_ns = kFrame_ns;
  facts->info.vendor_id = kVendorId;
  facts->info.product_id = kProductId;
  facts->info.input_report_bytes = kInputBytes;
  facts->info.output_report_bytes = kOutputBytes;
  std::strcpy(facts->info.product, "Simulated gantry");
  *device = arm;
  return THIMBLE_OK;
}

void destroy(void* device) { delete static_cast<Arm*>(device); }

void advance(void* device, std::int64_t t_ns) {
  Arm& arm = arm_of(device);
  if (!arm.is_started) arm.plant_ns = t_ns;
  arm.is_started = true;
  arm.now_ns = t_ns;
  while (arm.plant_ns + kSubstep_ns <= t_ns) step(arm);
}

void out_report(void* device, const std::uint8_t* bytes, std::uint32_t size) {
  Arm& arm = arm_of(device);
  if (size != kOutputBytes) return;
  std::uint8_t sum = 0;
  for (std::size_t i = 0; i + 1 < kOutputBytes; ++i) {
    sum = static_cast<std::uint8_t>(sum + bytes[i]);
  }
  if (sum != bytes[kOutputBytes - 1]) return;
  if (bytes[6] == kCommandForget) {
    arm.is_referenced = false;
    return switch_off(arm);
  }
  if (bytes[6] != kCommandDrive) return;
  arm.heard_ns = arm.now_ns;
  arm.is_on = arm.is_referenced;
  for (std::size_t i = 0; i < kAxes; ++i) {
    int milliampere = bytes[2 * i] + 256 * bytes[2 * i + 1];
    if (milliampere >= 32768) milliampere -= 65536;
    arm.current_a[i] =
        arm.is_on ? std::clamp(milliampere / 1000.0, -kPeakCurrent_a, kPeakCurrent_a) : 0;
  }
}

std::uint32_t in_report(void* device, std::uint8_t bytes[THIMBLE_REPORT_BYTES]) {
  const Arm& arm = arm_of(device);
  for (std::size_t i = 0; i < kAxes; ++i) {
    const double counts = std::floor((arm.place_m[i] - arm.zero_m[i]) * kCountsPerM);
    auto left = static_cast<std::uint32_t>(static_cast<std::int32_t>(counts));
    for (std::size_t byte = 0; byte < 4; ++byte, left /= 256) {
      bytes[4 * i + byte] = static_cast<std::uint8_t>(left % 256);
    }
  }
  bytes[12] = static_cast<std::uint8_t>((arm.is_referenced ? kFlagReferenced : 0) |
                                        (arm.is_stylus_down ? kFlagStylusButton : 0) |
                                        (arm.is_on ? kFlagMotorsOn : 0));
  return kInputBytes;
}

void power_cycle(void* device) {
  Arm& arm = arm_of(device);
  switch_off(arm);
  arm.is_referenced = false;
  arm.zero_m = arm.place_m;
}

void hold_tip(void* device, const thimble_tip_load* load) { arm_of(device).load = load; }

void push_tip(void* device, const double force_newton[3]) {
  arm_of(device).push_newton = from_base(force_newton);
}

std::int32_t move_tip_to(void* device, const double tip_m[3]) {
  Arm& arm = arm_of(device);
  const Axes place = from_base(tip_m);
  for (const double along_m : place) {
    if (std::abs(along_m) > kHalfTravel_m) return THIMBLE_REFUSED;
  }
  arm.place_m = place;
  arm.speed_m_per_s = {};
  return THIMBLE_OK;
}

void press_calibration_button(void* device, std::int32_t pressed) {
  arm_of(device).is_button_down = pressed != 0;
}

void press_stylus_button(void* device, std::int32_t pressed) {
  arm_of(device).is_stylus_held = pressed != 0;
  arm_of(device).is_stylus_down = pressed != 0;
}

void turn_stylus(void*, const double*) {}  // the tip is a ball

void read_truth(void* device, thimble_arm_truth* truth) {
  const Arm& arm = arm_of(device);
  truth->is_amplifier_on = arm.is_on ? 1 : 0;
  to_base(arm.place_m, truth->tip_m);
  to_base(arm.speed_m_per_s, truth->tip_velocity_m_per_s);
  to_base(motor_force_newton(arm), truth->motor_force_newton);
  for (std::size_t i = 0; i < kAxes; ++i) {
    truth->motor_current_a[i] = arm.current_a[i];
    truth->mechanical_energy_j += kMass_kg[i] * arm.speed_m_per_s[i] * arm.speed_m_per_s[i] / 2;
  }
}

}  // namespace

const thimble_model kModel = {
    sizeof(thimble_model),
    0,
    "gantry",
    "a gantry of three belts, of the sample plugin (HID)",
    &create,
    &destroy,
    &advance,
    &out_report,
    &in_report,
    &power_cycle,
    &hold_tip,
    &push_tip,
    &move_tip_to,
    &press_calibration_button,
    &press_stylus_button,
    &turn_stylus,
    &read_truth,
};

}  // namespace gantry
