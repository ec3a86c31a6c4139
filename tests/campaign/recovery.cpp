#include <algorithm>
#include <cmath>

#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

constexpr double kFaces = 1.7320508075688772;  // three faces of a cell at once

// Nothing jumps when force comes back: the gain rises along the ramp from zero, and the ghost
// starts at the hand, so that no more is asked for than a wall learned of this very tick may ask:
// H deep (teleop.md 2(e)), and its damping.
class Recovery final : public Invariant {
 public:
  explicit Recovery(const Bounds& bounds) : bounds_(bounds) {}

  void see(const Observation& now, Findings& findings) override {
    const servo::ServoFrame& frame = now.servo.frame;
    if (frame.state != OperatingState::Active) {
      was_driving_ = false;
      was_stale_ = false;
      return;
    }
    const bool is_restarted =
        !was_driving_ || (was_let_go_ && frame.gain > 0) || (was_stale_ && !frame.is_stale);
    if (!was_driving_) gain_ = 0;
    if (is_restarted && !frame.is_stale && bounds_.is_world_honest) {
      findings.at_most("force asked for at a restart, N", norm(frame.wish), newest_wall(frame));
    }
    see_gain(frame, findings);
    was_let_go_ = frame.gain == 0 && !frame.is_stale;
    was_driving_ = true;
    was_stale_ = frame.is_stale;
  }

 private:
  [[nodiscard]] double newest_wall(const servo::ServoFrame& frame) const noexcept {
    const double wall_newton =
        kFaces * bounds_.stiffness_newton_per_m * bounds_.hysteresis_m * (1 + 1e-6) +
        bounds_.damping_newton_s_per_m * norm(frame.velocity);
    return (1 + bounds_.friction) * wall_newton + 1e-6;
  }

  // While samples are stale the gain falls along another ramp, and returns to its own at once.
  void see_gain(const servo::ServoFrame& frame, Findings& findings) {
    const double step = seconds(frame.dt) / seconds(bounds_.servo.activation_ramp);
    gain_ = std::min(1.0, gain_ + step);
    findings.at_most("gain after a restart", frame.gain, gain_ + 1e-9);
    if (!frame.is_stale) gain_ = frame.gain;
    findings.at_most("force sent beyond its gain, N", norm(frame.force),
                     gain_ * bounds_.servo.limiter.max_force_newton + 1e-9);
  }

  Bounds bounds_;
  double gain_{0};
  bool was_driving_{false};
  bool was_let_go_{false};
  bool was_stale_{false};
};

}  // namespace

std::unique_ptr<Invariant> make_recovery(const Bounds& bounds) {
  return std::make_unique<Recovery>(bounds);
}

}  // namespace thimble::campaign
