#pragma once

#include <algorithm>
#include <cmath>
#include <deque>

#include "daemon/coupling/energy_observer.hpp"
#include "delayed_loop.hpp"
#include "fake_box.hpp"

namespace thimble::coupling::testing {

// A person's finger on one axis of an arm: 0.15 kg, drawn to a reference by 200 N/m and
// 4 N·s/m, 0.04 N dry friction (teleop.md 3). The plant runs at 20 kHz below a 1 kHz servo
// that sees positions 1 ms old, in steps of 0.03 mm, and whose force arrives 1 ms later.
class HandOnArm {
 public:
  HandOnArm(ArmCoupling& arm, Duration delay, Pace pace, double start_m)
      : box_(0.015), loop_(arm, box_, kServo, delay, pace), x_m_(start_m), seen_m_(2, start_m) {}
  // In another world than the box, from its origin.
  HandOnArm(ArmCoupling& arm, std::unique_ptr<WorldCoupling> world, Duration delay)
      : box_(0), loop_(arm, std::move(world), kServo, delay, Pace::Streamed), seen_m_(2, 0.0) {}

  // One servo tick with the finger drawn to `reference_m`, moving at `reference_m_per_s`.
  ArmOutput tick(double reference_m, double reference_m_per_s) {
    seen_m_.push_back(std::round(x_m_ / kResolution_m) * kResolution_m);
    const double raw_m_per_s = (seen_m_[1] - seen_m_[0]) / kServo_s;
    filtered_m_per_s_ += kFilterShare * (raw_m_per_s - filtered_m_per_s_);
    const ArmOutput output = loop_.tick({seen_m_[1], 0, 0}, {filtered_m_per_s_, 0, 0});
    seen_m_.pop_front();
    for (int i = 0; i < kSubsteps; ++i) move(reference_m, reference_m_per_s);
    motor_newton_ = std::clamp(output.force.x, -kClamp_newton, kClamp_newton);
    return output;
  }

  [[nodiscard]] double x_m() const { return x_m_; }
  [[nodiscard]] const EnergyObserver& energy() const { return energy_; }

 private:
  static constexpr Duration kServo = std::chrono::milliseconds(1);
  static constexpr double kServo_s = 1e-3;
  static constexpr int kSubsteps = 20;
  static constexpr double kResolution_m = 0.03e-3;
  static constexpr double kFilterShare = 0.5;  // 1 kHz: about 110 Hz
  static constexpr double kClamp_newton = 8.5;

  void move(double reference_m, double reference_m_per_s) {
    const double dt_s = kServo_s / kSubsteps;
    const double pull_newton = 200 * (reference_m - x_m_) + 4 * (reference_m_per_s - v_m_per_s_);
    const double friction_newton = 0.04 * std::tanh(v_m_per_s_ / 1e-3);
    const double before_m_per_s = v_m_per_s_;
    v_m_per_s_ += dt_s * (pull_newton + motor_newton_ - friction_newton) / 0.15;
    x_m_ += dt_s * v_m_per_s_;
    energy_.add({motor_newton_, 0, 0}, {(before_m_per_s + v_m_per_s_) / 2, 0, 0},
                from_seconds(dt_s));
  }

  FakeBox box_;
  DelayedLoop loop_;
  double x_m_{0};
  double v_m_per_s_{0};
  double filtered_m_per_s_{0};
  double motor_newton_{0};
  std::deque<double> seen_m_;
  EnergyObserver energy_{};
};

}  // namespace thimble::coupling::testing
