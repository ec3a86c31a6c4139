#include <algorithm>
#include <chrono>

#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

// DESIGN section 4, constraint age.
constexpr Duration kFadeFloor = milliseconds(250);
constexpr Duration kFadeTime = milliseconds(100);
constexpr int kRoundTrips = 3;

// Whatever ought to end a force does: a hand that opens, a lease that goes, an arm that falls
// silent or runs away, a world that says no more.
class LetGo final : public Invariant {
 public:
  explicit LetGo(const Bounds& bounds) : bounds_(bounds) {
    // What is under way when the network falls silent still arrives.
    const Duration answer = kRoundTrips * bounds.round_trip + bounds.round_trip;
    silence_ = bounds.round_trip + std::max(kFadeFloor, answer) + kFadeTime;
  }

  void see(const Observation& now, Findings& findings) override {
    const servo::ServoFrame& frame = now.servo.frame;
    note(now);
    const Duration tick = std::max(frame.dt, bounds_.servo.period());
    if (frame.now - asked_for_ > bounds_.servo.release_ramp + tick) {
      findings.at_most("force sent to an arm that was let go, N", norm(frame.force), 0);
    }
    // Without a sample no force is worked out, and the last one is held and then fades: 20 ms.
    if (heard_ - network_up_ > silence_ + 2 * tick) {
      findings.at_most("force of walls of which nothing is heard, N", norm(frame.wish), 1e-9);
    }
    if (frame.state != OperatingState::Active) return;
    findings.at_most("driven without a fresh sample for, s", seconds(frame.now - heard_),
                     seconds(bounds_.servo.freshness.fault_after + tick));
    findings.at_most("speed of a tip that is driven, m/s", norm(frame.velocity),
                     bounds_.servo.overspeed_m_per_s);
  }

 private:
  void note(const Observation& now) noexcept {
    const servo::ServoFrame& frame = now.servo.frame;
    if (now.is_deadman_held && now.is_wanted) asked_for_ = frame.now;
    if (frame.read_status == IoStatus::Ok) heard_ = frame.now;
    // What answers of itself while the network is down is no network's silence.
    if (now.is_network_up || !bounds_.is_world_honest) network_up_ = frame.now;
  }

  Bounds bounds_;
  Duration silence_{};
  MonotonicTime asked_for_{};
  MonotonicTime heard_{};
  MonotonicTime network_up_{};
};

}  // namespace

std::unique_ptr<Invariant> make_let_go(const Bounds& bounds) {
  return std::make_unique<LetGo>(bounds);
}

}  // namespace thimble::campaign
