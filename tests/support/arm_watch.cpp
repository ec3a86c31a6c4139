#include "tests/support/arm_watch.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

// The motors show a force in another pose than the one it was worked out for, in steps of a
// milliampere, so at the arm a little more or less than the limit is no breach.
constexpr double kPoseShare = 0.03;
constexpr double kQuantum_newton = 0.02;
// From the servo's write to the motors: two frames of the bus and a PWM period.
constexpr Duration kReach = milliseconds(4);
constexpr Duration kRiseWindow = milliseconds(20);

}  // namespace

ArmWatch::ArmWatch(ClosedLoop& loop, std::size_t arm) : loop_(&loop), arm_(arm) {
  const servo::ServoFrame& frame = loop.frame(arm);
  previous_ = frame.force;
  if (frame.state == OperatingState::Active) last_driven_ = frame.now;
}

void ArmWatch::check(bool is_kept, const char* rule, double value) {
  if (is_kept || !breach_.empty()) return;
  breach_ = std::string(rule) + ": " + std::to_string(value) + " at " +
            std::to_string(seconds(loop_->now().since_epoch)) + " s";
}

void ArmWatch::see() {
  ++ticks_;
  const servo::ServoFrame& frame = loop_->frame(arm_);
  see_sent(frame);
  see_motors(frame, loop_->truth(arm_));
}

void ArmWatch::see_sent(const servo::ServoFrame& frame) {
  const servo::LimiterSettings& limits = loop_->settings().limiter;
  check(is_finite(frame.force) && is_finite(frame.tip) && is_finite(frame.offset), "finite", 0);
  const double newton = norm(frame.force);
  check(newton <= limits.max_force_newton * (1 + 1e-9), "force sent, N", newton);
  if (frame.state != OperatingState::Active) check(newton == 0, "force while not Active", newton);
  // Only growth is limited: what points against the force before starts from zero.
  const double dt_s = seconds(frame.dt);
  const double rise = (newton - norm(previous_)) / dt_s;
  check(rise <= limits.max_rise_newton_per_s * (1 + 1e-6), "rise sent, N/s", rise);
  if (dot(frame.force, previous_) <= 0) {
    check(newton / dt_s <= limits.max_rise_newton_per_s * (1 + 1e-6), "reversal, N/s",
          newton / dt_s);
  }
  previous_ = frame.force;
  peak_sent_newton_ = std::max(peak_sent_newton_, newton);
  peak_rise_ = std::max(peak_rise_, rise);
}

void ArmWatch::see_motors(const servo::ServoFrame& frame, const plugin::ArmTruth& truth) {
  const servo::LimiterSettings& limits = loop_->settings().limiter;
  const double newton = norm(truth.motor_force);
  check(newton <= limits.max_force_newton * (1 + kPoseShare) + kQuantum_newton,
        "force at the arm, N", newton);
  double largest_a = 0;
  for (std::size_t joint = 0; joint < 3; ++joint) {
    const double a = std::abs(truth.motor_current_a[joint]);
    check(a <= limits.peak_current_a[joint] + 0.001, "motor current, A", a);
    largest_a = std::max(largest_a, a);
  }
  if (frame.state == OperatingState::Active) last_driven_ = frame.now;
  if (frame.now - last_driven_ > kReach)
    check(largest_a == 0, "current while not Active", largest_a);

  recent_.push_back({frame.now, newton});
  while (frame.now - recent_.front().at > kRiseWindow) recent_.pop_front();
  const double most = limits.max_rise_newton_per_s * seconds(kRiseWindow + kReach);
  check(newton - recent_.front().newton <= most * (1 + kPoseShare) + kQuantum_newton,
        "rise at the arm, N in 20 ms", newton - recent_.front().newton);
  peak_motor_newton_ = std::max(peak_motor_newton_, newton);
  peak_motor_a_ = std::max(peak_motor_a_, largest_a);
}

}  // namespace thimble::test
