#pragma once

#include <algorithm>

#include "tests/support/closed_loop.hpp"

namespace thimble::test {

// A hand that is led along straight lines; unless told otherwise so firmly that a wall bends its
// way by 3 mm at most: it can be pushed through walls. Takes the arm over from the simulated
// person.
class GuidedHand final : public plugin::TipLoad {
 public:
  struct Grip {
    Stiffness stiffness{3000};
    Damping damping{30};
    double speed_m_per_s{0.1};
  };
  explicit GuidedHand(ClosedLoop& loop) : GuidedHand(loop, Grip{}) {}
  GuidedHand(ClosedLoop& loop, const Grip& grip)
      : loop_(&loop), grip_(grip), target_(loop.truth().tip) {
    loop.sim_arm().backend().hold_tip(this);
  }
  ~GuidedHand() override { loop_->sim_arm().backend().hold_tip(nullptr); }
  GuidedHand(const GuidedHand&) = delete;
  GuidedHand& operator=(const GuidedHand&) = delete;

  // At the speed of the grip, then still for 50 ms; `each` runs after every tick.
  void go(Position3 to, const std::function<void()>& each = {}) {
    const Position3 from = target_;
    const double steps =
        std::max(1.0, norm(to - from) / grip_.speed_m_per_s / seconds(loop_->settings().period()));
    for (double i = 1; i <= steps; ++i) {
      target_ = from + (to - from) * (i / steps);
      loop_->tick();
      if (each) each();
    }
    target_ = to;
    loop_->run(0.05, each);
  }

  Force3 force_on_tip(MonotonicTime /*t*/, Duration /*dt*/, Position3 tip,
                      Velocity3 velocity) noexcept override {
    Force3 force;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      force[axis] = grip_.stiffness.newton_per_m * (target_[axis] - tip[axis]) -
                    grip_.damping.newton_s_per_m * velocity[axis];
    }
    return force;
  }
  [[nodiscard]] bool is_button_pressed(MonotonicTime /*t*/) const noexcept override {
    return false;
  }

 private:
  ClosedLoop* loop_;
  Grip grip_;
  Position3 target_;
};

}  // namespace thimble::test
