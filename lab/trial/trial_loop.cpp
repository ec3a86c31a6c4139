#include "lab/trial/trial_loop.hpp"

#include <utility>

namespace thimble::lab {

TrialLoop::TrialLoop(std::unique_ptr<coupling::ArmCoupling> arm_half,
                     std::unique_ptr<coupling::WorldCoupling> world_half, const Settings& settings)
    : settings_(settings),
      arm_half_(std::move(arm_half)),
      world_half_(std::move(world_half)),
      link_({.mode = settings.mode, .impairment = settings.impairment}, *world_half_) {}

coupling::ArmOutput TrialLoop::tick(Position3 tip, Velocity3 velocity) {
  if (std::exchange(is_first_, false)) arm_half_->reset(now_, tip);
  const MonotonicTime end = now_ + settings_.dt;
  std::optional<MonotonicTime> due = link_.pump(now_);
  while (due && *due <= end) due = link_.pump(*due);
  now_ = end;
  coupling::ConstraintSet reply;
  const bool is_fresh = link_.arm_end().receive(reply) && is_up_;
  const coupling::ArmOutput output = arm_half_->step({.now = now_,
                                                      .dt = settings_.dt,
                                                      .tip = tip,
                                                      .tip_velocity = velocity,
                                                      .buttons = 0,
                                                      .fresh = is_fresh ? &reply : nullptr,
                                                      .link = link_.arm_end().quality()});
  if (is_up_) {
    link_.arm_end().send(output.sample);
    ++samples_sent_;
  }
  link_.pump(now_);
  return output;
}

}  // namespace thimble::lab
