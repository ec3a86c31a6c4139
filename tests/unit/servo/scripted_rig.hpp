#pragma once

#include <deque>
#include <functional>
#include <vector>

#include "daemon/servo/servo_loop.hpp"

// A servo on hand-moved parts: the test says what the arm reports and what the world wants.
namespace thimble::servo {

class HandClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override { return now_; }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    if (deadline > now_) now_ = deadline;
    now_ = now_ + oversleep;
    return oversleep;
  }
  void advance(Duration d) noexcept { now_ = now_ + d; }

  Duration oversleep{};

 private:
  MonotonicTime now_{std::chrono::seconds(1)};
};

class ScriptedDevice final : public HapticDevice {
 public:
  explicit ScriptedDevice(const Clock& clock) : clock_(clock) {
    able.model = "scripted";
    able.peak_force_newton = 8;
    able.device_watchdog = std::chrono::milliseconds(500);
    able.peak_current_a = {3, 3, 3};
    able.continuous_current_a = {1, 1, 1};
    state.calibration = CalibrationState::Ok;
    for (std::size_t i = 0; i < 3; ++i) state.motor_current_per_force.row[i][i] = 0.1;
  }
  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override { return able; }
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override { return ""; }
  [[nodiscard]] DeviceCounters counters() const noexcept override { return {}; }
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override { return {}; }
  void forget_calibration() noexcept override { state.calibration = CalibrationState::Unknown; }
  IoStatus read(HapticState& out) noexcept override {
    if (next_status != IoStatus::Ok) return next_status;
    state.sampled_at = clock_.now();
    ++state.sample_sequence;
    out = state;
    return IoStatus::Ok;
  }
  IoStatus write(const LimitedWrench& wrench) noexcept override {
    written.push_back(wrench.force());
    if (on_write) on_write();
    return write_status;
  }

  HapticState state{};
  IoStatus next_status{IoStatus::Ok};
  IoStatus write_status{IoStatus::Ok};
  std::function<void()> on_write;
  std::vector<Force3> written;
  HapticCapabilities able;  // a servo looks at them once, when it is made

 private:
  const Clock& clock_;
};

class ScriptedCoupling final : public coupling::ArmCoupling {
 public:
  Force3 wish{};
  int resets{0};
  int steps{0};
  int replies{0};
  Position3 reset_tip{};
  coupling::ArmInput last{};

 private:
  void restart(MonotonicTime, Position3 tip) noexcept override {
    ++resets;
    reset_tip = tip;
  }
  coupling::ArmOutput advance(const coupling::ArmInput& input) noexcept override {
    last = input;
    if (input.fresh != nullptr) ++replies;
    ++steps;
    coupling::ArmOutput out;
    out.force = wish;
    out.sample.sequence = static_cast<std::uint64_t>(steps);
    return out;
  }
};

class ScriptedLink final : public coupling::ArmLink {
 public:
  void send(const coupling::HandSample& sample) noexcept override { sent.push_back(sample); }
  bool receive(coupling::ConstraintSet& out) noexcept override {
    if (!has_reply) return false;
    has_reply = false;
    out.sequence = 77;
    return true;
  }
  [[nodiscard]] coupling::LinkQuality quality() const noexcept override { return {}; }

  std::vector<coupling::HandSample> sent;
  bool has_reply{false};
};

inline LimiterSettings generous_limits() {
  LimiterSettings settings;
  settings.max_force_newton = 8;
  settings.peak_current_a = {3, 3, 3};
  settings.continuous_current_a = {1, 1, 1};
  return settings;
}

struct ServoRig {
  explicit ServoRig(ServoSettings settings = {}) : settings_(with_limits(settings)) {}

  static ServoSettings with_limits(ServoSettings settings) {
    if (settings.limiter.max_force_newton == 0) settings.limiter = generous_limits();
    return settings;
  }
  void tick(int times = 1) {
    for (int i = 0; i < times; ++i) {
      clock.advance(settings_.period());
      sut.tick(Duration{});
    }
  }
  // Ticks through calibration into Active and past the activation ramp.
  void activate_fully() {
    controls.want_active = true;
    tick(static_cast<int>(settings_.rate_hz * 0.6));
  }
  // The emergency stop is pressed for one tick, which latches a fault.
  void press_estop() {
    controls.is_estop_healthy = false;
    tick();
    controls.is_estop_healthy = true;
  }
  [[nodiscard]] ServoSnapshot snapshot() const {
    ServoSnapshot out;
    EXPECT_TRUE(sut.snapshot(out));
    return out;
  }
  [[nodiscard]] OperatingState state() const { return snapshot().frame.state; }

  ServoSettings settings_;
  HandClock clock;
  ScriptedDevice device{clock};
  ScriptedCoupling coupling;
  ScriptedLink link;
  ServoControls controls;
  rt::Heartbeat heartbeat;
  ServoLoop sut{ServoParts{device, coupling, link, controls, clock, clock, &heartbeat}, settings_};
};

// Active, and told by its coupling to push with 4 N.
struct DrivenRig : ServoRig {
  DrivenRig() {
    coupling.wish = {4, 0, 0};
    activate_fully();
  }
};

}  // namespace thimble::servo
