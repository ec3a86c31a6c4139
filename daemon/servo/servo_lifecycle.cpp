// The states of an arm's servo: what leads from one to the next, and what a fault is.
#include "daemon/servo/servo_loop.hpp"

namespace thimble::servo {

bool ServoLoop::is_place_known(const ServoFrame& frame) const noexcept {
  return arm_.calibration == CalibrationState::Ok &&
         frame.sample_age <= settings_.freshness.fault_after;
}

// A puck pushes nobody: it moves its probe in from wherever it is.
bool ServoLoop::may_begin() const noexcept {
  return !has_motors_ || settings_.entry.contains(arm_.tip);
}

bool ServoLoop::is_kept_out(const ServoFrame& frame) const noexcept {
  const ServoControls& controls = parts_.controls;
  const bool is_let_go =
      is_driving() && is_let_go_ && controls.is_deadman_held.load(std::memory_order_relaxed);
  const bool is_waiting = is_let_go || (state_ == OperatingState::Inactive && !frame.is_stale);
  return is_waiting && !may_begin() && !is_released_ &&
         controls.want_active.load(std::memory_order_relaxed) &&
         controls.is_guarded.load(std::memory_order_relaxed);
}

void ServoLoop::answer_clear_request(bool is_healthy, const ServoFrame& frame) noexcept {
  const ClearRequest request = parts_.controls.clear_request.load(std::memory_order_relaxed);
  if (request.id == snapshot_.clear_answered) return;
  snapshot_.clear_answered = request.id;
  // A fault that waits behind a lost arm is told, and can be cleared, when the arm is back. One of
  // this very tick was seen by nobody: whoever named its number guessed it.
  const bool is_there = frame.read_status != IoStatus::Disconnected;
  // One that was pulled while it was driven is calibrated first, and cleared last.
  const bool is_too_soon = was_pulled_ && is_healthy && !is_place_known(frame);
  const bool is_known =
      state_ == OperatingState::Fault && latch_.fault().tick != tick_ && is_there && !is_too_soon;
  snapshot_.clear_outcome =
      is_known ? latch_.clear(request.fault, is_healthy) : ClearOutcome::NotLatched;
  if (snapshot_.clear_outcome != ClearOutcome::Cleared) return;
  was_pulled_ = false;
  is_driven_ = false;  // whoever cleared it has seen the arm
  apply(LifecycleEvent::ClearFault);
}

void ServoLoop::advance_lifecycle(ServoFrame& frame) noexcept {
  const bool is_gone = frame.read_status == IoStatus::Disconnected;
  if (is_gone && state_ != OperatingState::Lost) lose_arm(frame);
  if (!is_gone && state_ == OperatingState::Lost) take_arm_back(frame);
  const bool wants_active = parts_.controls.want_active.load(std::memory_order_relaxed) &&
                            parts_.controls.is_guarded.load(std::memory_order_relaxed);
  const bool is_homed = arm_.calibration == CalibrationState::Ok;
  const bool is_estop_healthy = parts_.controls.is_estop_healthy.load(std::memory_order_relaxed);
  switch (state_) {
    case OperatingState::Configured:
      if (frame.read_status != IoStatus::Ok) break;
      freshness_.restart(frame.now);
      commands_.restart();
      velocity_filter_.reset();
      apply(LifecycleEvent::Calibrate);
      break;
    case OperatingState::Calibrating:
      if (!is_homed) break;
      velocity_filter_.reset();
      apply(latch_.is_latched() ? LifecycleEvent::Fail : LifecycleEvent::Homed);
      break;
    case OperatingState::Inactive:
      if (!is_homed) {
        apply(LifecycleEvent::LoseHome);
      } else if (wants_active && !frame.is_stale && may_begin()) {
        enter_active(frame);
      }
      break;
    case OperatingState::Active:
      if (!is_homed) {
        fail(FaultCode::LostReference, frame);
      } else if (!wants_active && gain_.value() == 0) {
        apply(LifecycleEvent::Deactivate);
      }
      break;
    case OperatingState::Fault:
      if (was_pulled_ && !is_homed && is_estop_healthy) apply(LifecycleEvent::LoseHome);
      break;
    default:
      break;
  }
}

// A stop as any other where it may have pushed.
void ServoLoop::lose_arm(const ServoFrame& frame) noexcept {
  snapshot_.fault = {FaultCode::Disconnected, frame.now, frame.tick};
  if (state_ == OperatingState::Active && has_motors_) {
    fail(FaultCode::Disconnected, frame);
  } else if (was_active_) {
    // Who was never driven stopped nothing: an arm that comes and goes as it likes fills no disk.
    stops_.push_back(snapshot_.fault);
  }
  // Whatever stopped it: a host may be late to learn of a cable.
  was_pulled_ = was_pulled_ || (was_active_ && has_motors_ && latch_.is_latched());
  was_active_ = false;
  held_force_.note_loss();
  gain_.cut();
  arm_.calibration = CalibrationState::Unknown;
  apply(LifecycleEvent::Unplug);
}

void ServoLoop::take_arm_back(const ServoFrame& frame) noexcept {
  apply(LifecycleEvent::Return);
  apply(LifecycleEvent::Open);
  apply(LifecycleEvent::Configure);
  if (latch_.is_latched() && !was_pulled_) apply(LifecycleEvent::Fail);
  check_place(frame);
}

void ServoLoop::enter_active(const ServoFrame& frame) noexcept {
  was_active_ = true;
  apply(LifecycleEvent::Activate);
  restart_coupling(frame.now);
  gain_.cut();
  commands_.restart();  // zeros that did not leave are counted, and stop nothing
  energy_ = {};
  snapshot_.frame.contacts = 0;
}

void ServoLoop::fail(FaultCode code, const ServoFrame& frame) noexcept {
  gain_.cut();
  apply(LifecycleEvent::Fail);
  if (!latch_.latch(code, frame.now, frame.tick)) return;
  ++snapshot_.faults;
  latched_at_ = frame.now;
  // Who was never driven stopped nothing: with safety lines each start waits for a person.
  const bool is_worth_a_recording = code != FaultCode::Estop || was_active_;
  if (is_worth_a_recording) stops_.push_back(latch_.fault());
}

void ServoLoop::apply(LifecycleEvent event) noexcept {
  state_ = next_state(state_, event).value_or(state_);
}

}  // namespace thimble::servo
