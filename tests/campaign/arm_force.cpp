#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "tests/campaign/at_the_arm.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

constexpr double kQuantum_newton = 0.02;
// The motors show a force in another pose than the one it was worked out for: a hand's own motion,
// and what a tip that is shoved goes on its way over the lever of the force. 0.1 m is less than
// the reach of any of the arms in the middle of its work space.
constexpr double kPoseShare = 0.03;
constexpr double kLever_m = 0.1;
constexpr Duration kRiseWindow = milliseconds(20);
// A pose that was read wrong is forgotten after so long: the hold of the freshness rules.
constexpr Duration kDoubt = milliseconds(50);

// What reaches the arm and what its motors then do: current of each motor at the wire and in the
// windings, norm and rise of the force. Bytes that were changed after they left the servo are
// excused until the next report: no software can help that.
class ArmForce final : public Invariant {
 public:
  explicit ArmForce(const Bounds& bounds)
      : limits_(bounds.servo.limiter), workspace_radius_m_(bounds.workspace_radius_m) {}

  void see(const Observation& now, Findings& findings) override {
    const servo::ServoFrame& frame = now.servo.frame;
    findings.require("everything at the arm is finite",
                     is_finite(now.truth.motor_force) && is_finite(now.truth.tip));
    note_spoilt(now);
    reference_.see(now);
    const double newton = norm(now.truth.motor_force);
    const double speed_m_per_s = norm(now.truth.tip_velocity);
    if (!is_spoilt_) see_currents(now, findings);
    // Out there the same current is another force a millimetre on; the currents keep their bounds.
    if (norm(now.truth.tip - Position3{}) > workspace_radius_m_) doubted_at_ = frame.now;
    const bool is_pose_known = frame.now - doubted_at_ > kDoubt && reference_.is_true();
    const bool is_late = now.late_out_at == frame.now;
    if (is_late || frame.now - now.wire.last_report > kFresh) deaf_at_ = frame.now;
    const bool is_heard = frame.now - deaf_at_ > kReach;
    if (!is_spoilt_ && is_pose_known && is_heard) {
      const double share = kPoseShare + speed_m_per_s * seconds(kReach) / kLever_m;
      findings.at_most("norm of the force at the arm, N", newton,
                       limits_.max_force_newton * (1 + share) + kQuantum_newton);
      see_rise(frame.now, newton, speed_m_per_s, findings);
    } else {
      oldest_ = newest_ = 0;
    }
  }

 private:
  struct MotorForce {
    MonotonicTime at{};
    double newton{0};
  };

  void note_spoilt(const Observation& now) noexcept {
    const MonotonicTime t = now.servo.frame.now;
    if (now.spoilt_in != spoilt_in_) doubted_at_ = t;
    if (now.spoilt_out != spoilt_out_) {
      is_spoilt_ = true;
      spoilt_at_ = t;
      // The wrong one, and the one that puts it right.
      right_again_at_report_ = now.wire.reports + 2;
    }
    spoilt_in_ = now.spoilt_in;
    spoilt_out_ = now.spoilt_out;
    if (now.wire.reports < right_again_at_report_) right_since_ = t;
    if (is_spoilt_ && t - right_since_ > kReach) is_spoilt_ = false;
  }

  void see_currents(const Observation& now, Findings& findings) const {
    for (std::size_t motor = 0; motor < 3; ++motor) {
      const double peak_a = limits_.peak_current_a[motor] + kQuantum_a;
      findings.at_most("current asked for at the wire, A", now.wire.largest_a[motor], peak_a);
      findings.at_most("current of a motor, A", std::abs(now.truth.motor_current_a[motor]), peak_a);
    }
  }

  void see_rise(MonotonicTime t, double newton, double speed_m_per_s, Findings& findings) {
    recent_[newest_ % recent_.size()] = {t, newton};
    ++newest_;
    if (newest_ - oldest_ > recent_.size()) oldest_ = newest_ - recent_.size();
    while (t - recent_[oldest_ % recent_.size()].at > kRiseWindow) ++oldest_;
    const double most = limits_.max_rise_newton_per_s * seconds(kRiseWindow + kReach + kFresh);
    const double turned_newton = newton * speed_m_per_s * seconds(kRiseWindow + kReach) / kLever_m;
    findings.at_most("rise of the force at the arm in 20 ms, N",
                     newton - recent_[oldest_ % recent_.size()].newton,
                     most * (1 + kPoseShare) + turned_newton + kQuantum_newton);
  }

  servo::LimiterSettings limits_;
  double workspace_radius_m_;
  std::uint64_t spoilt_in_{0};
  std::uint64_t spoilt_out_{0};
  std::uint64_t right_again_at_report_{0};
  bool is_spoilt_{false};
  ReferenceWatch reference_;
  MonotonicTime spoilt_at_{Duration::min() / 2};
  MonotonicTime right_since_{Duration::min() / 2};
  MonotonicTime doubted_at_{Duration::min() / 2};
  MonotonicTime deaf_at_{Duration::min() / 2};
  std::array<MotorForce, 256> recent_{};  // 20 ms at 8 kHz are 160
  std::size_t oldest_{0};
  std::size_t newest_{0};
};

}  // namespace

std::unique_ptr<Invariant> make_arm_force(const Bounds& bounds) {
  return std::make_unique<ArmForce>(bounds);
}

}  // namespace thimble::campaign
