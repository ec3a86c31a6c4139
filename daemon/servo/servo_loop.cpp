#include "daemon/servo/servo_loop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace thimble::servo {
namespace {

// A coupling integrates over dt; beyond this the freshness rules have taken over anyway.
constexpr Duration kLongestStep = std::chrono::milliseconds(20);
// How late a tick is that is missed, where none may be, at the least. Ours: a frame of a full-speed
// bus, and a period of the default rate: a faster servo is not late by what no arm notices.
constexpr Duration kMissed = std::chrono::milliseconds(1);

std::size_t frames_for(const ServoSettings& settings) {
  const double frames = settings.rate_hz * seconds(settings.recording);
  return static_cast<std::size_t>(std::max(1.0, std::ceil(frames)));
}

}  // namespace

ServoLoop::ServoLoop(const ServoParts& parts, const ServoSettings& settings)
    : parts_(parts),
      settings_(settings),
      limiter_(settings.limiter),
      freshness_(settings.freshness),
      commands_(settings.freshness),
      gain_(settings.activation_ramp, settings.release_ramp),
      recorder_(frames_for(settings)),
      has_watchdog_(parts.device.capabilities().device_watchdog > Duration::zero()),
      has_motors_(parts.device.capabilities().is_actuated),
      state_(parts.is_lost ? OperatingState::Lost : OperatingState::Configured),
      held_force_(settings.command_gap_limit) {
  previous_now_ = parts_.clock.now() - settings_.period();
  snapshot_.clear_answered = parts_.controls.clear_request.load(std::memory_order_relaxed).id;
  ServoFrame before;
  before.state = state_;
  publish(before);
}

// The life of a tick: docs/architecture.md walks through it.
void ServoLoop::tick(Duration lateness) noexcept {
  const MonotonicTime started = parts_.stopwatch.now();
  ServoFrame frame = begin_frame(lateness);
  ask_guard(frame);
  take_state(frame);
  const MonotonicTime computing = parts_.stopwatch.now();
  check_freshness(frame);
  check_safety_inputs(frame);
  advance_lifecycle(frame);
  estimate_velocity(frame);
  couple(frame);
  const LimitedWrench wrench = limit(frame);
  observe_energy(frame);
  const MonotonicTime computed = parts_.stopwatch.now();
  write(frame, wrench);
  const MonotonicTime written = parts_.stopwatch.now();
  answer_guard(frame);
  record(frame);
  publish(frame);
  wakeup_error_.add(lateness);
  compute_.add(computed - computing);
  exchange_.add((computing - started) + (written - computed));
}

ServoFrame ServoLoop::begin_frame(Duration lateness) noexcept {
  ServoFrame frame;
  frame.tick = ++tick_;
  frame.now = parts_.clock.now();
  frame.lateness = lateness;
  frame.dt = frame.now - previous_now_;
  previous_now_ = frame.now;
  if (frame.dt <= Duration::zero()) frame.dt = settings_.period();
  snapshot_.overruns += static_cast<std::uint64_t>(lateness / settings_.period());
  away_since_write_ += std::max(Duration::zero(), frame.dt - settings_.period());

  // Counted from the first tick on: an arm that never takes a command must not look driven.
  if (tick_ == 1) {
    last_write_ = frame.now;
    away_since_write_ = {};
  }
  const bool is_command_overdue = frame.now - last_write_ > settings_.command_gap_limit;
  const bool is_tick_missed =
      settings_.is_realtime_required && tick_ > 1 &&
      frame.dt >= settings_.period() + std::max(settings_.period(), kMissed);
  if (state_ == OperatingState::Active && (is_command_overdue || is_tick_missed)) {
    fail(is_tick_missed ? FaultCode::ServoLate : fault_of_overdue_command(), frame);
  } else if (state_ == OperatingState::Active && commands_.is_full()) {
    fail(FaultCode::MissedExchanges, frame);
  }
  frame.dt = std::min(frame.dt, kLongestStep);
  return frame;
}

// Whose the larger share of the time is: the servo's, which did not run, or that of the arm and its
// bus, which took none of the commands.
FaultCode ServoLoop::fault_of_overdue_command() const noexcept {
  const bool was_away = away_since_write_ > settings_.command_gap_limit / 2;
  return was_away ? FaultCode::ServoLate : FaultCode::CommandTimeout;
}

// An arm that its guard let go is driven no more until a person clears it: it had no fresh command
// for too long, whatever this thread's clock says. So is one that was being deactivated: driven
// again at once, it would be told forces by the servo and zero by its guard.
void ServoLoop::ask_guard(const ServoFrame& frame) noexcept {
  if (parts_.heartbeat == nullptr) return;
  const std::uint32_t now = parts_.heartbeat->interventions.load(std::memory_order_acquire);
  const bool is_let_go = now != interventions_;
  interventions_ = now;
  const bool is_stopped = state_ == OperatingState::Fault || state_ == OperatingState::Lost;
  const bool may_hold_force = state_ == OperatingState::Active || (is_driven_ && !is_stopped);
  if (is_let_go && may_hold_force) fail(FaultCode::ServoLate, frame);
}

// The guard watches from the first force on, and until the arm has taken nothing but zero for so
// long that an earlier force cannot be under way any more. It sees no beat of a servo whose
// commands do not leave: its own way to the arm may be free.
void ServoLoop::answer_guard(const ServoFrame& frame) noexcept {
  if (parts_.heartbeat == nullptr) return;
  const bool is_let_go = zero_since_ && zeros_taken_ >= kOksOfAZeroThatArrived &&
                         frame.now - *zero_since_ >= settings_.command_gap_limit;
  if (is_let_go || state_ == OperatingState::Lost) is_driven_ = false;
  parts_.heartbeat->drive.store(is_driven_ ? drive_ : 0, std::memory_order_release);
  const bool is_stuck = is_driven_ && frame.now - last_write_ > settings_.command_gap_limit;
  if (!is_stuck) parts_.heartbeat->beat(frame.now);
}

void ServoLoop::take_state(ServoFrame& frame) noexcept {
  frame.read_status = parts_.device.read(arm_);
  frame.calibration = arm_.calibration;
  frame.buttons = arm_.buttons;
  frame.tip = arm_.tip;
  frame.sample_age = frame.now - arm_.sampled_at;
  if (frame.read_status == IoStatus::ProtocolError) ++snapshot_.protocol_errors;
  held_force_.note_sample(frame.read_status == IoStatus::Ok);
  // The place of one that is lost is judged once it is back: take_arm_back().
  if (state_ != OperatingState::Lost) check_place(frame);
}

void ServoLoop::check_place(const ServoFrame& frame) noexcept {
  if (frame.read_status == IoStatus::Ok && !is_finite(arm_.tip)) {
    fail(FaultCode::NonFiniteState, frame);
  }
}

void ServoLoop::check_freshness(ServoFrame& frame) noexcept {
  is_outage_over_ = false;
  freshness_gain_ = 1;
  if (!is_exchanging()) return;
  const FreshnessVerdict verdict =
      freshness_.judge(frame.now, arm_.sampled_at, frame.read_status == IoStatus::Ok);
  freshness_gain_ = verdict.gain;
  frame.is_stale = verdict.is_stale;
  is_outage_over_ = verdict.is_outage_over;
  // Silence stops nothing of one that stands still after a fault and is calibrated again.
  if (verdict.fault != FaultCode::None && !latch_.is_latched()) fail(verdict.fault, frame);
}

void ServoLoop::check_safety_inputs(ServoFrame& frame) noexcept {
  const bool is_estop_healthy = parts_.controls.is_estop_healthy.load(std::memory_order_relaxed);
  if (!is_estop_healthy && state_ != OperatingState::Lost) fail(FaultCode::Estop, frame);
  const bool is_guarded = parts_.controls.is_guarded.load(std::memory_order_relaxed);
  if (!is_guarded && state_ == OperatingState::Active) fail(FaultCode::GuardLost, frame);

  answer_clear_request(is_estop_healthy, frame);
}

// The ghost starts again at the hand, wherever it went while it felt nothing.
void ServoLoop::restart_coupling(MonotonicTime now) noexcept {
  parts_.coupling.reset(now, arm_.tip);
  // What the world said before the pause speaks of another place of the hand.
  (void)parts_.link.receive(reply_);
  last_wish_ = {};
  is_let_go_ = false;
}

void ServoLoop::estimate_velocity(ServoFrame& frame) noexcept {
  const bool is_moving_known = frame.calibration == CalibrationState::Ok;
  if (frame.read_status == IoStatus::Ok && is_moving_known) {
    velocity_filter_.update(arm_.sampled_at, arm_.tip);
  }
  frame.velocity = velocity_filter_.velocity();
  if (state_ == OperatingState::Active && norm(frame.velocity) > settings_.overspeed_m_per_s) {
    fail(FaultCode::Overspeed, frame);
  }
}

// Of an arm that is driven; of any other it says nothing. One that was let go begins anew.
bool ServoLoop::may_drive() const noexcept {
  if (is_let_go_ && !may_begin()) return false;
  return !is_released_ && parts_.controls.want_active.load(std::memory_order_relaxed) &&
         parts_.controls.is_deadman_held.load(std::memory_order_relaxed);
}

void ServoLoop::couple(ServoFrame& frame) noexcept {
  frame.contacts = snapshot_.frame.contacts;
  if (!is_driving()) return felt_.reset(frame.now, arm_.tip);
  if (is_outage_over_) parts_.coupling.reset(frame.now, arm_.tip);
  if (is_let_go_ && may_drive()) restart_coupling(frame.now);
  if (frame.is_stale) {
    frame.wish = last_wish_;
    frame.offset = snapshot_.frame.offset;
    return;
  }
  const bool is_fresh_reply = parts_.link.receive(reply_);
  const coupling::ArmInput input{.now = frame.now,
                                 .dt = frame.dt,
                                 .tip = arm_.tip,
                                 .tip_velocity = frame.velocity,
                                 .buttons = arm_.buttons,
                                 .fresh = is_fresh_reply ? &reply_ : nullptr,
                                 .link = parts_.link.quality()};
  coupling::ArmOutput out = parts_.coupling.step(input);
  presses_.count(arm_.buttons, out.sample);
  parts_.controls.actions.count(out.sample);
  felt_.observe(input, out);
  frame.wish = out.force;
  frame.offset = out.offset;
  frame.is_in_contact = out.is_in_contact;
  frame.is_frozen = out.is_frozen;
  frame.is_fading = out.is_fading;
  frame.contacts += out.new_contacts;
  snapshot_.total_contacts += out.new_contacts;
  last_wish_ = out.force;
  // One sample per report of the arm: a faster servo has nothing new to tell.
  if (frame.read_status == IoStatus::Ok) parts_.link.send(out.sample);
}

LimitedWrench ServoLoop::limit(ServoFrame& frame) noexcept {
  if (!is_driving()) {
    gain_.cut();
    return limiter_.cut(frame.dt);
  }
  frame.gain = gain_.step(may_drive(), frame.dt) * freshness_gain_;
  is_let_go_ = is_let_go_ || gain_.value() == 0;
  const LimiterOutput out = limiter_.limit({.wish = frame.wish,
                                            .motor_current_per_force = arm_.motor_current_per_force,
                                            .gain = frame.gain,
                                            .dt = frame.dt});
  frame.is_limited = out.is_norm_clamped || out.is_rise_limited || out.is_current_clamped;
  if (out.fault != FaultCode::None) fail(out.fault, frame);
  frame.force = out.wrench.force();
  return out.wrench;
}

void ServoLoop::observe_energy(ServoFrame& frame) noexcept {
  energy_.add(frame.force, frame.velocity, frame.dt);
  frame.generated_energy_j = energy_.given_joule();
  frame.wished_energy_j = parts_.coupling.energy().given_joule();
}

bool ServoLoop::is_silent(MonotonicTime now) const noexcept {
  if (state_ != OperatingState::Fault || !zero_since_ || !has_watchdog_) return false;
  // Its watchdog had its turn while the plug was out; another would cost the new reference.
  if (was_pulled_) return false;
  return now - std::max(latched_at_, *zero_since_) > settings_.zero_before_silence;
}

void ServoLoop::write(ServoFrame& frame, const LimitedWrench& wrench) noexcept {
  frame.state = state_;
  frame.fault = latch_.fault().code;
  if (state_ == OperatingState::Lost) return;
  if (is_silent(frame.now)) return;
  if (is_driving()) {
    if (!std::exchange(is_driven_, true)) drive_ = std::max(drive_ + 1, 1U);
    // Before the force: the guard must know of it whenever this process ends.
    if (parts_.heartbeat != nullptr) {
      parts_.heartbeat->drive.store(drive_, std::memory_order_release);
    }
  }
  frame.write_status = parts_.device.write(wrench);
  const bool is_taken = frame.write_status == IoStatus::Ok;
  held_force_.note_command(frame.now, wrench.force() == Force3{}, is_taken);
  if (is_exchanging()) commands_.judge(frame.now, is_taken, frame.sample_age);
  // A servo that is faster than the bus finds it busy now and then: that breaks no row of zeros.
  const bool is_row_broken = frame.now - last_write_ > settings_.command_gap_limit;
  if (is_driving() || is_row_broken) zero_since_.reset();
  if (!is_driving() && is_taken) {
    if (!zero_since_) zeros_taken_ = 0;
    zero_since_ = zero_since_.value_or(frame.now);
    ++zeros_taken_;
  }
  // Only a command that the bus took is one: a stuck way out must not look fresh.
  if (!is_taken) return;
  last_write_ = frame.now;
  away_since_write_ = {};
}

void ServoLoop::record(ServoFrame& frame) noexcept {
  if (stops_.empty()) return recorder_.record(frame);
  // Every recording ends with the tick of its own stop.
  for (const Fault& cause : stops_) recorder_.freeze(frame, cause);
  stops_.clear();
}

void ServoLoop::publish(const ServoFrame& frame) noexcept {
  snapshot_.frame = frame;
  snapshot_.was_pulled = was_pulled_;
  snapshot_.may_hold_force = held_force_.may_hold();
  snapshot_.is_kept_out = is_kept_out(frame);
  snapshot_.is_place_known = is_place_known(frame);
  snapshot_.missed_exchanges = freshness_.missed() + commands_.missed();
  snapshot_.felt = felt_.felt();
  const auto gimbal = arm_.joint_position_rad.begin() + kFirstGimbalJoint;
  std::copy_n(gimbal, snapshot_.gimbal_rad.size(), snapshot_.gimbal_rad.begin());
  if (latch_.is_latched()) snapshot_.fault = latch_.fault();
  if (!latch_.is_latched() && state_ != OperatingState::Lost) snapshot_.fault = {};
  snapshot_.peak_force_newton = std::max(snapshot_.peak_force_newton, norm(frame.force));
  snapshot_.peak_offset_m = std::max(snapshot_.peak_offset_m, norm(frame.offset));
  published_.store(snapshot_);
}

}  // namespace thimble::servo
