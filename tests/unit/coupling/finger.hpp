#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>

#include "daemon/coupling/energy_observer.hpp"

namespace thimble::coupling::testing {

// A person's finger on one axis of an arm: 0.15 kg, drawn to a reference by 200 N/m and
// 4 N·s/m, 0.04 N dry friction (teleop.md 3). The plant runs at 20 kHz below a 1 kHz servo
// that sees positions 1 ms old, in steps of 0.03 mm, and whose force arrives 1 ms later.
class Finger {
 public:
  static constexpr Duration kServo = std::chrono::milliseconds(1);

  explicit Finger(double start_m) : x_m_(start_m), seen_m_(2, start_m) {}

  struct Sight {
    double x_m{0};
    double v_m_per_s{0};
  };
  // What the servo sees in this tick.
  Sight look() {
    seen_m_.push_back(std::round(x_m_ / kResolution_m) * kResolution_m);
    const double raw_m_per_s = (seen_m_[1] - seen_m_[0]) / kServo_s;
    filtered_m_per_s_ += kFilterShare * (raw_m_per_s - filtered_m_per_s_);
    seen_m_.pop_front();
    return {seen_m_[0], filtered_m_per_s_};
  }
  // One servo tick, drawn to `reference_m`, which moves at `reference_m_per_s`.
  void move(double reference_m, double reference_m_per_s, double commanded_newton) {
    for (int i = 0; i < kSubsteps; ++i) step(reference_m, reference_m_per_s);
    motor_newton_ = std::clamp(commanded_newton, -kClamp_newton, kClamp_newton);
  }

  [[nodiscard]] double x_m() const { return x_m_; }
  [[nodiscard]] double v_m_per_s() const { return v_m_per_s_; }
  [[nodiscard]] const EnergyObserver& energy() const { return energy_; }

 private:
  static constexpr double kServo_s = 1e-3;
  static constexpr int kSubsteps = 20;
  static constexpr double kResolution_m = 0.03e-3;
  static constexpr double kFilterShare = 0.5;  // 1 kHz: about 110 Hz
  static constexpr double kClamp_newton = 8.5;

  void step(double reference_m, double reference_m_per_s) {
    const double dt_s = kServo_s / kSubsteps;
    const double pull_newton = 200 * (reference_m - x_m_) + 4 * (reference_m_per_s - v_m_per_s_);
    const double friction_newton = 0.04 * std::tanh(v_m_per_s_ / 1e-3);
    const double before_m_per_s = v_m_per_s_;
    v_m_per_s_ += dt_s * (pull_newton + motor_newton_ - friction_newton) / 0.15;
    x_m_ += dt_s * v_m_per_s_;
    energy_.add({motor_newton_, 0, 0}, {(before_m_per_s + v_m_per_s_) / 2, 0, 0},
                from_seconds(dt_s));
  }

  double x_m_{0};
  double v_m_per_s_{0};
  double filtered_m_per_s_{0};
  double motor_newton_{0};
  std::deque<double> seen_m_;
  EnergyObserver energy_{};
};

// Approach from 30 mm before the wall at 0.2 m/s to 20 mm behind it, hold, retract; 5 s in all.
struct Reference {
  double x_m{-0.015};
  double v_m_per_s{0};

  // The tick's move; `tick` counts milliseconds.
  void advance(int tick) {
    v_m_per_s = 0;
    if (tick < kHoldTo_tick && x_m < 0.035) v_m_per_s = 0.2;
    if (tick >= kHoldTo_tick && x_m > -0.015) v_m_per_s = -0.2;
    x_m += 1e-3 * v_m_per_s;
  }

  static constexpr int kTicks = 5000;
  static constexpr int kHoldFrom_tick = 2500;
  static constexpr int kHoldTo_tick = 4500;
};

}  // namespace thimble::coupling::testing
