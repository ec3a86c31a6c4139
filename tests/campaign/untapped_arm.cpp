#include <algorithm>
#include <chrono>
#include <cmath>

#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

// From the servo's write to the motors of a Falcon on a cable that is well: an exchange under way,
// the bridge's latency timer, a frame, and a tick (arms.md: 1.3 ms an exchange).
constexpr Duration kUntappedReach = milliseconds(8);
// After a disturbance: an arm that nobody heard for half a second is sent a zero every 50 ms
// (decision 0286).
constexpr Duration kFoundAgain = milliseconds(60);
constexpr Duration kLookedFor = std::chrono::seconds(2) + milliseconds(50);
// Its tip and the pose that the counts say differ by what a hand goes on its way; motors take whole
// counts.
constexpr double kPoseShare = 0.1;
constexpr double kQuantum_newton = 0.05;
// A pose that was read wrong is forgotten after so long: the hold of the freshness rules.
constexpr Duration kDoubt = milliseconds(50);

// An arm that has no watchdog and whose wire nobody reads: what its motors do, on a cable that has
// been well for as long as an exchange takes. Nothing else would take a force away from it.
class UntappedArm final : public Invariant {
 public:
  explicit UntappedArm(const Bounds& bounds)
      : limits_(bounds.servo.limiter), tick_(bounds.servo.period()) {}

  void see(const Observation& now, Findings& findings) override {
    const servo::ServoFrame& frame = now.servo.frame;
    const Force3 force = now.truth.motor_force;
    findings.require("everything at the arm is finite",
                     is_finite(force) && is_finite(now.truth.tip));
    if (now.spoilt_in != spoilt_in_) doubted_at_ = frame.now;
    spoilt_in_ = now.spoilt_in;
    const Duration reach = kUntappedReach + 2 * std::max(tick_, frame.dt);
    const MonotonicTime well_since = std::max(now.cable_ok_since, now.opening_ok_since);
    // Nobody reaches an arm that is not open; it is looked for at least so often.
    const bool is_unreached =
        frame.state == OperatingState::Lost && frame.now - well_since <= kLookedFor;
    if (norm(frame.force) > 0 || is_unreached) asked_at_ = frame.now;
    // Its motors keep what they had, in whatever pose a hand brings it to.
    if (is_unreached) doubted_at_ = frame.now;
    const MonotonicTime heard_since = well_since + kFoundAgain;
    if (frame.now - std::max(asked_at_, heard_since) > reach) {
      findings.at_most("force of motors of which nothing is asked, N", norm(force), 0);
    }
    // Until it is heard again it has the currents of another pose, too.
    if (frame.now - std::max(heard_since, doubted_at_ + kDoubt) > reach) {
      findings.at_most("norm of the force at the arm, N", norm(force),
                       limits_.max_force_newton * (1 + kPoseShare) + kQuantum_newton);
    }
  }

 private:
  servo::LimiterSettings limits_;
  Duration tick_;
  MonotonicTime asked_at_{};
  MonotonicTime doubted_at_{Duration::min() / 2};
  std::uint64_t spoilt_in_{0};
};

}  // namespace

std::unique_ptr<Invariant> make_untapped_arm(const Bounds& bounds) {
  return std::make_unique<UntappedArm>(bounds);
}

}  // namespace thimble::campaign
