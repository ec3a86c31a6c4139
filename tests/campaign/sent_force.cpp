#include <algorithm>
#include <cmath>

#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

// The force that leaves the limiter: finite, within its norm, rising no faster than it may, and
// none at all while the arm is not Active.
class SentForce final : public Invariant {
 public:
  explicit SentForce(const Bounds& bounds) : limits_(bounds.servo.limiter) {}

  void see(const Observation& now, Findings& findings) override {
    const servo::ServoFrame& frame = now.servo.frame;
    findings.require("everything published is finite",
                     is_finite(frame.force) && is_finite(frame.tip) && is_finite(frame.velocity) &&
                         is_finite(frame.offset) &&
                         is_finite(frame.gain, frame.generated_energy_j, 0));
    const double newton = norm(frame.force);
    findings.at_most("norm of the force sent, N", newton, limits_.max_force_newton * (1 + 1e-9));
    if (frame.state != OperatingState::Active) {
      findings.at_most("force sent while not Active, N", newton, 0);
    }
    const double reach = limits_.max_rise_newton_per_s *
                         seconds(std::min<Duration>(frame.dt, servo::WrenchLimiter::kLongestRise));
    findings.at_most("rise of the force sent, N", rise_to(frame.force), reach * (1 + 1e-6) + 1e-9);
    previous_ = frame.force;
  }

 private:
  // How far `force` is from every force that only a fall leads to: those between zero and the one
  // before.
  [[nodiscard]] double rise_to(Force3 force) const noexcept {
    const double squared = dot(previous_, previous_);
    const double share = squared > 0 ? dot(force, previous_) / squared : 0;
    return norm(force - std::clamp(share, 0.0, 1.0) * previous_);
  }

  servo::LimiterSettings limits_;
  Force3 previous_{};
};

}  // namespace

std::unique_ptr<Invariant> make_sent_force(const Bounds& bounds) {
  return std::make_unique<SentForce>(bounds);
}

}  // namespace thimble::campaign
