#include <algorithm>
#include <chrono>
#include <cmath>

#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

// What the milliseconds that a force takes to the motors make in one touch, at most: measured with
// a healthy cable 0.17 mJ in 4 million ticks (tests/scenario/delay_test.cpp has 0.06 mJ for the
// plainest arm), 0.38 mJ in 2 * 10^8, of a tip that was shoved.
constexpr double kOnTheWay_j = 0.5e-3;
// How long a disturbance of the cable, of the network or of the ticks shows.
constexpr Duration kAftermath = milliseconds(150);
// A ghost in matter that an edit brought is pushed out, with force: four cells at 0.1 m/s at most.
constexpr Duration kPushOut = milliseconds(1200);
// Walls that a silence took away come back as slowly as they went (DESIGN 4, constraint age).
constexpr double kFade_s = 0.1;
// No hand of the campaign is faster by itself. A tip that is shoved moves on while its force is on
// the way: at 1 m/s by 3 mm, which no wall behind this bus makes good. And at 0.25 m/s it leaves a
// wall with 0.8 mJ more than it brought, at 500 Hz: K * 5 ms * (the integral of its speed squared).
constexpr double kByHand_m_per_s = 0.3;

// A touch gives the hand no more than it took, but for what teleop.md 2(e) grants: for each contact
// the wall that is H deep at once, and what the coordinate spring stores in the offset; and what a
// rising gain adds to a spring that is pressed already. Work at the motors on the true tip. A touch
// that met the limiter, wrong bytes, or a disturbed cable, network or servo is not judged.
class Energy final : public Invariant {
 public:
  explicit Energy(const Bounds& bounds) : bounds_(bounds) {}

  void see(const Observation& now, Findings& findings) override {
    if (!bounds_.is_energy_bounded) return;
    const servo::ServoFrame& frame = now.servo.frame;
    if (norm(now.truth.motor_force) == 0 && norm(force_) == 0) begin_touch(frame);
    is_touched_ = is_touched_ || norm(now.truth.motor_force) > 0;
    const Force3 mean = 0.5 * (force_ + now.truth.motor_force);
    given_j_ += dot(mean, now.truth.tip - tip_);
    force_ = now.truth.motor_force;
    tip_ = now.truth.tip;
    allow(frame);
    excuse(now);
    if (!is_excused_) findings.at_most("energy made by a touch, J", given_j_, allowed(frame));
  }

  void tell(Judged& judged) const override {
    judged.touches += judged_.touches;
    judged.excused_touches += judged_.excused_touches;
  }

 private:
  void begin_touch(const servo::ServoFrame& frame) noexcept {
    if (is_touched_) ++(is_excused_ ? judged_.excused_touches : judged_.touches);
    is_touched_ = false;
    given_j_ = 0;
    raised_j_ = 0;
    offset_m_ = 0;
    // The contact that begins a touch was counted when its force was sent, a report or two ago.
    if (norm(frame.wish) == 0) contacts_before_ = frame.contacts;
    is_excused_ = false;
  }

  void allow(const servo::ServoFrame& frame) noexcept {
    follow_fade(frame);
    const double gain = frame.gain * fade_gain_;
    const double full_newton = fade_gain_ > 0 ? norm(frame.wish) / fade_gain_ : 0;
    const double stored_j = full_newton * full_newton / (2 * bounds_.stiffness_newton_per_m);
    raised_j_ += std::max(0.0, gain - gain_) * stored_j;
    gain_ = gain;
    offset_m_ = std::max(offset_m_, norm(frame.offset));
  }

  // The coupling's own gain, which the wish has in it.
  void follow_fade(const servo::ServoFrame& frame) noexcept {
    if (frame.state != OperatingState::Active) {
      fade_gain_ = 1;
      return;
    }
    const double share = seconds(frame.dt) / kFade_s;
    fade_gain_ = std::clamp(fade_gain_ + (frame.is_fading ? -share : share), 0.0, 1.0);
  }

  void excuse(const Observation& now) noexcept {
    const servo::ServoFrame& frame = now.servo.frame;
    const bool is_disturbed = frame.now - now.cable_ok_since < kAftermath ||
                              frame.now - now.network_ok_since < kAftermath ||
                              frame.now - now.tip_ok_since < kAftermath ||
                              frame.now - now.world_ok_since < kAftermath + kPushOut;
    // A contact counter that starts again belongs to another activation.
    const bool is_another = frame.contacts < contacts_before_;
    const bool is_shoved = norm(now.truth.tip_velocity) > kByHand_m_per_s;
    is_excused_ = is_excused_ || is_disturbed || is_another || is_shoved || frame.is_limited ||
                  frame.is_stale || frame.is_fading;
  }

  [[nodiscard]] double allowed(const servo::ServoFrame& frame) const noexcept {
    const double contacts = frame.contacts - contacts_before_;
    const double h_m = bounds_.hysteresis_m;
    return contacts * 0.5 * bounds_.stiffness_newton_per_m * h_m * h_m +
           0.5 * bounds_.coordinate_spring_newton_per_m * offset_m_ * offset_m_ + raised_j_ +
           kOnTheWay_j;
  }

  Bounds bounds_;
  double given_j_{0};
  double raised_j_{0};
  double offset_m_{0};
  double gain_{0};
  double fade_gain_{1};
  std::uint32_t contacts_before_{0};
  bool is_excused_{false};
  bool is_touched_{false};
  Judged judged_{};
  Force3 force_{};
  Position3 tip_{};
};

}  // namespace

std::unique_ptr<Invariant> make_energy(const Bounds& bounds) {
  return std::make_unique<Energy>(bounds);
}

}  // namespace thimble::campaign
