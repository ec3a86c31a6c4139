#pragma once

#include <array>
#include <cstdint>

#include "drivers/phantom/phantom_wire.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// Fact, arms.md 3.1 (HID variant).
inline constexpr Duration kPwmPeriod = from_seconds(1 / phantom::wire::kPwmHz);
// Ours: the controller's timer counts the 96 MHz clock of an LPC1768, 48000 ticks a period.
inline constexpr double kPwmTicks = 48'000;

// Three servo amplifiers in current mode behind three PWM outputs and one enable line.
//
// A duty that the firmware writes takes effect at the start of the next PWM period, as the
// timer's shadow registers do; the enable line acts at once. The current then follows without
// delay: the amplifier's own loop is an order of magnitude faster than the PWM.
//
// Thread: one. RT: all. Errors: none; a duty beyond the amplifier's input range gives the
// current at its end, so that no value can drive more than `full_scale_a`.
class MotorAmplifier {
 public:
  // Of the PWM outputs; the HID build's unless said otherwise.
  struct Pwm {
    Duration period{kPwmPeriod};
    double period_counts{kPwmTicks};
  };

  // `phase`: when, after power-up, the first PWM period starts.
  MotorAmplifier(double full_scale_a, Duration phase) noexcept
      : MotorAmplifier(full_scale_a, phase, {}) {}
  MotorAmplifier(double full_scale_a, Duration phase, const Pwm& pwm) noexcept
      : full_scale_a_(full_scale_a), phase_(phase), pwm_(pwm) {}

  THIMBLE_RT void power_up(MonotonicTime t) noexcept;
  THIMBLE_RT void write_current(MonotonicTime t, const std::array<double, 3>& current_a) noexcept;
  THIMBLE_RT void enable() noexcept { is_on_ = true; }
  THIMBLE_RT void disable() noexcept;
  // Lets PWM periods that began until `t` take effect.
  THIMBLE_RT void run_until(MonotonicTime t) noexcept;

  [[nodiscard]] bool is_on() const noexcept { return is_on_; }
  // What flows in the motors, A.
  THIMBLE_RT [[nodiscard]] std::array<double, 3> current_a() const noexcept;
  [[nodiscard]] std::uint64_t saturations() const noexcept { return saturations_; }

 private:
  [[nodiscard]] double duty_of(double current_a) noexcept;
  [[nodiscard]] MonotonicTime next_period_start(MonotonicTime t) const noexcept;

  double full_scale_a_;
  Duration phase_;
  Pwm pwm_;
  MonotonicTime powered_at_{};
  bool is_on_{false};
  bool has_pending_{false};
  MonotonicTime pending_from_{};
  std::array<double, 3> pending_duty_{};
  std::array<double, 3> duty_{};
  std::uint64_t saturations_{0};  // motor commands beyond full scale
};

}  // namespace thimble::sim
