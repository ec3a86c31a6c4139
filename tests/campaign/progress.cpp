#include <chrono>

#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

constexpr Duration kPatience = milliseconds(50);
// A lost arm is looked for at least so often (daemon/session/arm_session.hpp), and what was opened
// is taken with the next tick.
constexpr Duration kLookedFor = std::chrono::seconds(2) + kPatience;
// An arm that went unheard for less is still searched for, with a zero every 50 ms (decision 0286).
constexpr Duration kShortOutage = std::chrono::seconds(5);
constexpr Duration kFoundAgain = milliseconds(60);

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
  void tell(Judged& judged) const override {
    if (!bounds_.is_tapped) judged.ticks_due_on_usb += ticks_due_;
  }

 private:
  void see_samples(const Observation& now, Findings& findings) {
    const servo::ServoFrame& frame = now.servo.frame;
    const bool is_expected =
        frame.state != OperatingState::Lost && frame.state != OperatingState::Fault;
    if (frame.read_status == IoStatus::Ok) heard_at_ = frame.now;
    if (!is_expected || frame.read_status == IoStatus::Ok) expected_since_ = frame.now;
    const MonotonicTime due_at = due_since(now);
    if (is_expected && frame.now - due_at > kPatience) ++ticks_due_;
    const MonotonicTime from = std::max(expected_since_, due_at);
    findings.at_most("no sample taken for, s", seconds(frame.now - from), seconds(kPatience));
  }

  // From when an arm that is open has to be heard.
  [[nodiscard]] MonotonicTime due_since(const Observation& now) const noexcept {
    // A search that began a moment ago still goes by zeros, and what runs answers the next one.
    const bool is_search =
        now.cable_ok_since - heard_at_ <= kShortOutage && now.truth.is_amplifier_on;
    const Duration silence = is_search ? std::min(bounds_.silence, kFoundAgain) : bounds_.silence;
    // The firmware of an arm that lost its power is not there at once.
    const bool is_booted = heard_at_ > now.opening_ok_since;
    return std::max(now.cable_ok_since + silence,
                    now.opening_ok_since + (is_booted ? Duration{} : bounds_.boot));
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
  MonotonicTime heard_at_{};
  std::uint64_t ticks_due_{0};
  MonotonicTime expected_since_{};
  MonotonicTime answered_{};
  MonotonicTime there_{};
};

}  // namespace

std::unique_ptr<Invariant> make_progress(const Bounds& bounds) {
  return std::make_unique<Progress>(bounds);
}

}  // namespace thimble::campaign
