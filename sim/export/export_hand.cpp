#include "sim/export/export_hand.hpp"

namespace thimble::sim {

void ExportHand::take_hold() noexcept {
  left_of_first_leg_ = {};
  if (has_hold_) return;
  has_hold_ = true;
  hand_ =
      Hand(HandSettings{.motion = HandMotion::Still});  // one that takes hold where the tip is now
  arm_->hold_tip(this);
}

void ExportHand::go_home(Duration within) noexcept {
  take_hold();
  const Position3 start = arm_->calibration_start();
  if (start == arm_->home_position()) {
    hand_.hold_at(start, within);
    return;
  }
  second_leg_ = within / 2;
  left_of_first_leg_ = within - second_leg_;
  hand_.hold_at(start, left_of_first_leg_);
}

void ExportHand::move_to(Position3 point, Duration within) noexcept {
  take_hold();
  hand_.hold_at(point, within);
}

void ExportHand::let_go() noexcept {
  has_hold_ = false;
  left_of_first_leg_ = {};
  arm_->hold_tip(nullptr);
}

Force3 ExportHand::force_on_tip(MonotonicTime t, Duration dt, Position3 tip,
                                Velocity3 velocity) noexcept {
  if (left_of_first_leg_ > Duration{0}) {
    left_of_first_leg_ -= dt;
    if (left_of_first_leg_ <= Duration{0}) hand_.hold_at(arm_->home_position(), second_leg_);
  }
  return hand_.force_on_tip(t, dt, tip, velocity);
}

}  // namespace thimble::sim
