#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "tests/support/closed_loop.hpp"

namespace thimble::test {

// What no tick of any session may break, judged by what the servo sent and by what the motors
// of the simulated arm then did: everything finite, force norm, current of each motor, rise of
// force, and nothing at all while the arm is not Active. Looks at one arm; call see() after
// each tick.
class ArmWatch {
 public:
  explicit ArmWatch(ClosedLoop& loop, std::size_t arm = 0);

  void see();

  // Empty: nothing was broken. Else the first breach in words.
  [[nodiscard]] const std::string& breach() const noexcept { return breach_; }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  // The largest seen, so that a test can show that the limit was reached at all.
  [[nodiscard]] double peak_sent_newton() const noexcept { return peak_sent_newton_; }
  [[nodiscard]] double peak_motor_newton() const noexcept { return peak_motor_newton_; }
  [[nodiscard]] double peak_motor_a() const noexcept { return peak_motor_a_; }
  // Largest rise of the sent force from one tick to the next over the time between, N/s.
  [[nodiscard]] double peak_rise() const noexcept { return peak_rise_; }

 private:
  void check(bool is_kept, const char* rule, double value);
  void see_sent(const servo::ServoFrame& frame);
  void see_motors(const servo::ServoFrame& frame, const plugin::ArmTruth& truth);

  struct MotorForce {
    MonotonicTime at{};
    double newton{0};
  };

  ClosedLoop* loop_;
  std::size_t arm_;
  std::uint64_t ticks_{0};
  std::string breach_;
  Force3 previous_{};
  MonotonicTime last_driven_{Duration::min() / 2};
  std::deque<MotorForce> recent_;  // of the last 20 ms
  double peak_sent_newton_{0};
  double peak_motor_newton_{0};
  double peak_motor_a_{0};
  double peak_rise_{0};
};

}  // namespace thimble::test
