#include <chrono>
#include <cmath>

#include "drivers/phantom/phantom_wire.hpp"
#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

// A report under way when the stop came: handed over in this frame or the next one.
constexpr Duration kUnderWay = milliseconds(2);
// From a report's arrival to the motors: the frame that brings it, and a PWM period.
constexpr Duration kStopReach = milliseconds(2);

// After a stop, whatever it was: no report asks for a current any more, and the motors are dead as
// soon as one report arrived; where none arrives the arm's own watchdog does it.
class ZeroAfterStop final : public Invariant {
 public:
  explicit ZeroAfterStop(const Bounds& /*bounds*/) {}

  void see(const Observation& now, Findings& findings) override {
    const servo::ServoFrame& frame = now.servo.frame;
    if (now.spoilt_out != spoilt_out_) spoilt_at_ = frame.now;
    spoilt_out_ = now.spoilt_out;
    if (frame.state == OperatingState::Active) {
      stopped_at_ = frame.now;
      heard_at_.reset();
      was_active_ = true;
      return;
    }
    if (was_active_) see_stop(frame, findings);
    was_active_ = false;
    // One that is late was written before the stop; what follows it was not.
    if (heard_at_ && now.wire.last_nonzero >= *heard_at_) heard_at_.reset();
    const bool is_heard = now.wire.last_report > stopped_at_ + kUnderWay &&
                          now.wire.last_report > now.wire.last_nonzero;
    if (!heard_at_ && is_heard) heard_at_ = now.wire.last_report;
    // By when it arrived, not by when that is seen: the servo may wake late.
    if (now.wire.last_nonzero - spoilt_at_ <= 2 * kUnderWay ||
        now.wire.last_nonzero - now.late_out_at <= kUnderWay) {
      excused_ = now.wire.last_nonzero;
    }
    if (now.wire.last_nonzero > excused_) {
      findings.at_most("a report asks for current so long after a stop, s",
                       seconds(now.wire.last_nonzero - stopped_at_), seconds(kUnderWay));
    }
    // What was spoilt acts until another report comes, or until the watchdog.
    if (frame.now - spoilt_at_ <= phantom::wire::kWatchdog + 2 * kUnderWay) return;
    const MonotonicTime dead_at =
        heard_at_ ? *heard_at_ + kStopReach
                  : now.wire.last_report + phantom::wire::kWatchdog + kStopReach;
    if (frame.now > dead_at && frame.now > stopped_at_ + kUnderWay + kStopReach)
      see_motors(now, findings);
  }

 private:
  void see_stop(const servo::ServoFrame& frame, Findings& findings) {
    const bool is_gone = frame.state == OperatingState::Lost;
    findings.require("a stop is written in its own tick",
                     is_gone || frame.write_status != IoStatus::NoData);
  }

  void see_motors(const Observation& now, Findings& findings) {
    for (const double current_a : now.truth.motor_current_a) {
      findings.at_most("current of a motor after a stop, A", std::abs(current_a), 0);
    }
  }

  MonotonicTime stopped_at_{Duration::min() / 2};
  std::optional<MonotonicTime> heard_at_;  // the first report after the stop
  MonotonicTime spoilt_at_{Duration::min() / 2};
  MonotonicTime excused_{Duration::min() / 2};  // the last current that nobody asked for
  std::uint64_t spoilt_out_{0};
  bool was_active_{false};
};

}  // namespace

std::unique_ptr<Invariant> make_zero_after_stop(const Bounds& bounds) {
  return std::make_unique<ZeroAfterStop>(bounds);
}

}  // namespace thimble::campaign
