#include <chrono>

#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

constexpr Duration kPatience = milliseconds(50);
// A lost arm is looked for at least so often (daemon/session/arm_session.hpp), and what was opened
// is taken with the next tick.
constexpr Duration kLookedFor = std::chrono::seconds(2) + kPatience;

// Nothing stands still for longer than 50 ms once nothing stands in its way: ticks advance, samples
// are taken, the world's replies are used, a lost arm is opened again.
class Progress final : public Invariant {
 public:
  explicit Progress(const Bounds& bounds) : bounds_(bounds) {}

  void see(const Observation& now, Findings& findings) override {
    const servo::ServoFrame& frame = now.servo.frame;
    findings.require("ticks advance one by one", tick_ == 0 || frame.tick == tick_ + 1);
    findings.require("time advances", tick_ == 0 || frame.now > now_);
    tick_ = frame.tick;
    now_ = frame.now;
    see_samples(now, findings);
    see_replies(now, findings);
    see_opening(now, findings);
    findings.at_most("an edit waits for, s", seconds(frame.now - now.edits_ok_since),
                     seconds(kPatience));
  }

 private:
  void see_samples(const Observation& now, Findings& findings) {
    const servo::ServoFrame& frame = now.servo.frame;
    const bool is_expected =
        frame.state != OperatingState::Lost && frame.state != OperatingState::Fault;
    if (!is_expected || frame.read_status == IoStatus::Ok) expected_since_ = frame.now;
    // The firmware of an arm that lost its power is not there at once.
    const MonotonicTime from = std::max(
        expected_since_,
        std::max(now.cable_ok_since + bounds_.silence, now.opening_ok_since + bounds_.boot));
    findings.at_most("no sample taken for, s", seconds(frame.now - from), seconds(kPatience));
  }

  void see_replies(const Observation& now, Findings& findings) {
    const servo::ServoFrame& frame = now.servo.frame;
    const bool is_expected =
        frame.state == OperatingState::Active && !frame.is_stale && bounds_.is_network_lossless;
    if (!is_expected || !frame.is_frozen) answered_ = frame.now;
    const MonotonicTime from = std::max(std::max(answered_, now.network_ok_since),
                                        std::max(now.cable_ok_since, now.replies_ok_since));
    findings.at_most("no reply used for, s", seconds(frame.now - from),
                     seconds(kPatience + 2 * bounds_.round_trip));
  }

  void see_opening(const Observation& now, Findings& findings) {
    const servo::ServoFrame& frame = now.servo.frame;
    if (frame.state != OperatingState::Lost) there_ = frame.now;
    const MonotonicTime from = std::max(std::max(there_, now.opening_ok_since), now.cable_ok_since);
    findings.at_most("an arm that is there stays lost for, s", seconds(frame.now - from),
                     seconds(kLookedFor + bounds_.silence));
  }

  Bounds bounds_;
  std::uint64_t tick_{0};
  MonotonicTime now_{};
  MonotonicTime expected_since_{};
  MonotonicTime answered_{};
  MonotonicTime there_{};
};

}  // namespace

std::unique_ptr<Invariant> make_progress(const Bounds& bounds) {
  return std::make_unique<Progress>(bounds);
}

}  // namespace thimble::campaign
