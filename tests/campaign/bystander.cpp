#include <chrono>

#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

// A simulated person calibrates, and the force ramps up.
constexpr Duration kDriven = std::chrono::seconds(5);
constexpr Duration kPatience = milliseconds(50);

// Another arm of the process, to which nothing is done: whatever happens to the first one, it is
// driven when it has had its time, stays so, latches nothing, misses no tick and no sample, and its
// force keeps its own bounds. Its world may change: that is felt, no more.
class Bystander final : public Invariant {
 public:
  explicit Bystander(const Bounds& bounds) : sent_force_(make_sent_force(others(bounds))) {}

  void see(const Observation& now, Findings& findings) override {
    if (now.other == nullptr) return;
    own_.servo = *now.other;
    const servo::ServoFrame& frame = own_.servo.frame;
    findings.require("an arm nearby: ticks advance one by one",
                     tick_ == 0 || frame.tick == tick_ + 1);
    tick_ = frame.tick;
    findings.require("an arm nearby: latches nothing", own_.servo.faults == 0);
    const bool is_driven = frame.state == OperatingState::Active;
    findings.require("an arm nearby: stays driven", is_driven || !was_driven_);
    was_driven_ = was_driven_ || is_driven;
    findings.require("an arm nearby: is driven in time",
                     is_driven || frame.now.since_epoch < kDriven);
    if (frame.read_status == IoStatus::Ok) sampled_at_ = frame.now;
    findings.at_most("an arm nearby: no sample taken for, s", seconds(frame.now - sampled_at_),
                     seconds(kPatience));
    sent_force_->see(own_, findings);
  }

 private:
  static Bounds others(const Bounds& bounds) {
    Bounds own = bounds;
    own.servo = bounds.other_servo;
    return own;
  }

  std::unique_ptr<Invariant> sent_force_;
  Observation own_{};
  std::uint64_t tick_{0};
  bool was_driven_{false};
  MonotonicTime sampled_at_{};
};

}  // namespace

std::unique_ptr<Invariant> make_bystander(const Bounds& bounds) {
  return std::make_unique<Bystander>(bounds);
}

}  // namespace thimble::campaign
