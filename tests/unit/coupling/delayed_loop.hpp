#pragma once

#include <deque>
#include <memory>
#include <utility>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/felt_hand.hpp"
#include "daemon/coupling/ghost_point_world.hpp"

namespace thimble::coupling::testing {

enum class Pace { Streamed, LockStep };

// Arm half, world half and a channel whose replies take `delay` from sample to arrival.
// Lock-step sends the next sample when the reply to the last has arrived, as in 1999.
class DelayedLoop {
 public:
  DelayedLoop(ArmCoupling& arm, world::World& world, Duration dt, Duration delay,
              Pace pace = Pace::Streamed)
      : DelayedLoop(arm, std::make_unique<GhostPointWorld>(world, 1), dt, delay, pace) {}
  DelayedLoop(ArmCoupling& arm, std::unique_ptr<WorldCoupling> world, Duration dt, Duration delay,
              Pace pace)
      : arm_(arm), world_(std::move(world)), dt_(dt), delay_(delay), pace_(pace) {
    arm_.reset(now_, {});
    (void)world_->open({});
  }

  ArmOutput tick(Position3 tip, Velocity3 velocity) {
    now_ = now_ + dt_;
    ConstraintSet fresh;
    ArmInput input{.now = now_, .dt = dt_, .tip = tip, .tip_velocity = velocity};
    input.link = {.is_up = true, .round_trip = delay_};
    while (!pending_.empty() && pending_.front().at <= now_) {
      fresh = pending_.front().set;
      input.fresh = &fresh;
      pending_.pop_front();
    }
    const ArmOutput output = arm_.step(input);
    felt_.observe(input, output);
    if (pace_ == Pace::Streamed || pending_.empty()) {
      pending_.push_back({now_ + delay_, world_->answer(output.sample, dt_)});
    }
    return output;
  }

  [[nodiscard]] const FeltHand& felt() const { return felt_.felt(); }

 private:
  struct Pending {
    MonotonicTime at;
    ConstraintSet set;
  };
  ArmCoupling& arm_;
  std::unique_ptr<WorldCoupling> world_;
  Duration dt_;
  Duration delay_;
  Pace pace_;
  MonotonicTime now_{};
  FeltHandObserver felt_;
  std::deque<Pending> pending_;
};

}  // namespace thimble::coupling::testing
