#include "sim/model/hand/person.hpp"

namespace thimble::sim {

Person::Person(plugin::ArmBackend& arm, const HandSettings& settings) : arm_(arm), hand_(settings) {
  begin_calibration();
  arm_.hold_tip(this);
}

Person::~Person() {
  arm_.press_calibration_button(false);
  arm_.hold_tip(nullptr);
}

void Person::begin_calibration() noexcept {
  arm_.press_calibration_button(false);
  elapsed_ = {};
  is_told_to_move_ = false;
  const Position3 start = arm_.calibration_start();
  const bool starts_at_home = start == arm_.home_position();
  phase_ = starts_at_home ? Phase::GoingHome : Phase::GoingToStart;
  hand_.hold_at(start, starts_at_home ? kHomeAt : kStartAt);
}

Force3 Person::force_on_tip(MonotonicTime t, Duration dt, Position3 tip,
                            Velocity3 velocity) noexcept {
  const bool is_asked = is_asked_.exchange(false, std::memory_order_relaxed);
  if (is_asked && phase_ == Phase::Moving) begin_calibration();
  if (phase_ == Phase::GoingToStart && elapsed_ >= kStartAt) {
    hand_.hold_at(arm_.home_position(), kHomeAt - kStartAt);
    phase_ = Phase::GoingHome;
  }
  if (phase_ == Phase::GoingHome && elapsed_ >= kPressAt) {
    arm_.press_calibration_button(true);
    phase_ = Phase::Pressing;
  }
  if (phase_ == Phase::Pressing && elapsed_ >= kReleaseAt) {
    arm_.press_calibration_button(false);
    phase_ = Phase::Waiting;
  }
  if (phase_ == Phase::Waiting && (is_told_to_move_ || elapsed_ >= kMotionAt)) {
    hand_.start_motion();
    phase_ = Phase::Moving;
  }
  elapsed_ += dt;
  return hand_.force_on_tip(t, dt, tip, velocity);
}

}  // namespace thimble::sim
