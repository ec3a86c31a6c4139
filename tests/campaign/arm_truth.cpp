#include <chrono>
#include <cmath>

#include "tests/campaign/at_the_arm.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

// Counts, their age and the velocity filter hide so much of a speed, and for so long.
constexpr double kSpeedShare = 1.25;
constexpr Duration kSpeedSeen = milliseconds(20);

// What the servo says of itself, held against what the arm does: motors of which it asks nothing
// are dead, whatever the reason, and a tip that truly runs away is not driven.
class ArmTruth final : public Invariant {
 public:
  explicit ArmTruth(const Bounds& bounds)
      : tick_(bounds.servo.period()), fast_m_per_s_(bounds.servo.overspeed_m_per_s * kSpeedShare) {}

  void see(const Observation& now, Findings& findings) override {
    const servo::ServoFrame& frame = now.servo.frame;
    note(now);
    if (frame.now - asked_at_ > kReach + kFresh && frame.now - unheard_at_ > kReach + kFresh) {
      for (const double current_a : now.truth.motor_current_a) {
        findings.at_most("current of a motor of which nothing is asked, A", std::abs(current_a),
                         kQuantum_a);
      }
    }
    if (frame.state != OperatingState::Active || !reference_.is_true()) return;
    findings.at_most("driven though its tip runs away for, s", seconds(frame.now - slow_at_),
                     seconds(kSpeedSeen + 2 * tick_));
  }

 private:
  void note(const Observation& now) noexcept {
    const servo::ServoFrame& frame = now.servo.frame;
    if (norm(frame.force) > 0 || frame.write_status == IoStatus::NoData) asked_at_ = frame.now;
    const bool is_spoilt = now.spoilt_out != spoilt_out_;
    spoilt_out_ = now.spoilt_out;
    const bool is_late = now.late_out_at == frame.now;
    if (is_spoilt || is_late || frame.now - now.wire.last_report > kFresh) unheard_at_ = frame.now;
    // A servo that sleeps or hears nothing cannot know; both have rules of their own.
    const bool is_blind = frame.now < now.cable_ok_since + kSpeedSeen || frame.dt > 2 * tick_;
    const bool is_slow = norm(now.truth.tip_velocity) < fast_m_per_s_;
    if (is_blind || is_slow || frame.state != OperatingState::Active) slow_at_ = frame.now;
    reference_.see(now);
  }

  Duration tick_;
  double fast_m_per_s_;
  MonotonicTime asked_at_{};
  MonotonicTime unheard_at_{};
  MonotonicTime slow_at_{};
  std::uint64_t spoilt_out_{0};
  ReferenceWatch reference_;
};

}  // namespace

std::unique_ptr<Invariant> make_arm_truth(const Bounds& bounds) {
  return std::make_unique<ArmTruth>(bounds);
}

}  // namespace thimble::campaign
