#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/arm_link.hpp"
#include "daemon/coupling/energy_observer.hpp"
#include "daemon/coupling/felt_hand.hpp"
#include "daemon/coupling/press_counter.hpp"
#include "daemon/servo/command_freshness.hpp"
#include "daemon/servo/drive_gain.hpp"
#include "daemon/servo/entry_box.hpp"
#include "daemon/servo/flight_recorder.hpp"
#include "daemon/servo/held_force.hpp"
#include "daemon/servo/sample_freshness.hpp"
#include "daemon/servo/servo_controls.hpp"
#include "daemon/servo/servo_frame.hpp"
#include "daemon/servo/servo_snapshot.hpp"
#include "daemon/servo/tick_histogram.hpp"
#include "daemon/servo/velocity_filter.hpp"
#include "daemon/servo/wrench_limiter.hpp"
#include "hal/base/time.hpp"
#include "hal/device/fault.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/device/operating_state.hpp"
#include "hal/rt/annotations.hpp"
#include "hal/rt/heartbeat.hpp"
#include "hal/rt/static_vector.hpp"
#include "hal/rt/word_seqlock.hpp"

namespace thimble::servo {

// Defaults: DESIGN section 4. All limits are times and rates, never counts of ticks.
struct ServoSettings {
  double rate_hz{1000};
  LimiterSettings limiter{};
  FreshnessSettings freshness{};
  double overspeed_m_per_s{1.5};
  Duration activation_ramp{std::chrono::milliseconds(500)};
  Duration release_ramp{std::chrono::milliseconds(20)};
  Duration command_gap_limit{std::chrono::milliseconds(20)};
  // After a latched fault zero is still written until the arm has taken it for this long (so that
  // it surely arrives); then it hears nothing and its own watchdog takes the power away. One
  // without a watchdog hears zero for good, and so does one that was unplugged after it was driven:
  // its watchdog had its turn.
  Duration zero_before_silence{std::chrono::milliseconds(100)};
  bool is_realtime_required{false};
  EntryBox entry{};  // an arm with motors is driven from within; everywhere where it has no end
  Duration recording{std::chrono::seconds(2)};

  [[nodiscard]] Duration period() const noexcept { return from_seconds(1.0 / rate_hz); }
};

// What the loop works on; all must outlive it.
struct ServoParts {
  HapticDevice& device;
  coupling::ArmCoupling& coupling;
  coupling::ArmLink& link;
  const ServoControls& controls;
  const Clock& clock;                 // stamps the arm's samples too; virtual for a simulated arm
  const Clock& stopwatch;             // only measures what a tick costs; never decides anything
  rt::Heartbeat* heartbeat{nullptr};  // of the arm's guard; nullptr: it has none
  bool is_lost{false};                // the arm is not there yet: Lost from the start, and no stop
};

// One arm's servo: state → freshness → safety inputs → lifecycle → velocity → coupling →
// limiter → energy → write → record → publish, once per call of tick().
//
// Thread: tick() from the servo thread only; snapshot() and the histograms from any;
//         recorder().take() from one control thread.
// RT: tick() is THIMBLE_RT_IO: the device's exchange and the link's wake, nothing else.
// Ownership: allocates at construction only.
// Errors: latched in the snapshot; the arm then gets zero force at once.
class ServoLoop {
 public:
  ServoLoop(const ServoParts& parts, const ServoSettings& settings);

  // `lateness`: how late the caller woke for this tick.
  THIMBLE_RT_IO void tick(Duration lateness) noexcept;
  // Periods that the caller left out because the previous tick took too long.
  THIMBLE_RT void count_skipped(std::uint64_t periods) noexcept { snapshot_.overruns += periods; }
  // The arm is let go for good, whatever the controls say: ramps to zero like a released deadman.
  THIMBLE_RT void release() noexcept { is_released_ = true; }
  // True when the arm gets no force: nothing is lost by stopping now.
  [[nodiscard]] bool is_at_rest() const noexcept { return gain_.value() == 0; }

  // False when the servo wrote all the while (try again).
  [[nodiscard]] bool snapshot(ServoSnapshot& out) const noexcept { return published_.load(out); }
  [[nodiscard]] const TickHistogram& wakeup_error() const noexcept { return wakeup_error_; }
  [[nodiscard]] const TickHistogram& compute() const noexcept { return compute_; }
  [[nodiscard]] const TickHistogram& exchange() const noexcept { return exchange_; }
  [[nodiscard]] FlightRecorder& recorder() noexcept { return recorder_; }
  [[nodiscard]] const ServoSettings& settings() const noexcept { return settings_; }

 private:
  ServoFrame begin_frame(Duration lateness) noexcept;
  void ask_guard(const ServoFrame& frame) noexcept;
  void answer_guard(const ServoFrame& frame) noexcept;
  [[nodiscard]] FaultCode fault_of_overdue_command() const noexcept;
  void take_state(ServoFrame& frame) noexcept;
  void check_freshness(ServoFrame& frame) noexcept;
  void check_safety_inputs(ServoFrame& frame) noexcept;
  void check_place(const ServoFrame& frame) noexcept;
  [[nodiscard]] bool is_place_known(const ServoFrame& frame) const noexcept;
  void answer_clear_request(bool is_healthy, const ServoFrame& frame) noexcept;
  void advance_lifecycle(ServoFrame& frame) noexcept;
  void lose_arm(const ServoFrame& frame) noexcept;
  void take_arm_back(const ServoFrame& frame) noexcept;
  void enter_active(const ServoFrame& frame) noexcept;
  void estimate_velocity(ServoFrame& frame) noexcept;
  void couple(ServoFrame& frame) noexcept;
  void observe_energy(ServoFrame& frame) noexcept;
  LimitedWrench limit(ServoFrame& frame) noexcept;
  void write(ServoFrame& frame, const LimitedWrench& wrench) noexcept;
  void record(ServoFrame& frame) noexcept;
  void publish(const ServoFrame& frame) noexcept;

  void fail(FaultCode code, const ServoFrame& frame) noexcept;
  void apply(LifecycleEvent event) noexcept;
  void restart_coupling(MonotonicTime now) noexcept;
  [[nodiscard]] bool is_driving() const noexcept { return state_ == OperatingState::Active; }
  // Before the first sample there is nothing to be missed; after a stop the arm is silent.
  [[nodiscard]] bool is_exchanging() const noexcept {
    return state_ == OperatingState::Calibrating || state_ == OperatingState::Inactive ||
           is_driving();
  }
  [[nodiscard]] bool is_silent(MonotonicTime now) const noexcept;
  [[nodiscard]] bool may_drive() const noexcept;
  [[nodiscard]] bool may_begin() const noexcept;
  [[nodiscard]] bool is_kept_out(const ServoFrame& frame) const noexcept;

  ServoParts parts_;
  ServoSettings settings_;
  WrenchLimiter limiter_;
  SampleFreshness freshness_;
  CommandFreshness commands_;
  VelocityFilter velocity_filter_;
  DriveGain gain_;
  coupling::EnergyObserver energy_;  // since activation
  coupling::FeltHandObserver felt_;  // for the eye
  coupling::PressCounter presses_;
  FaultLatch latch_;
  FlightRecorder recorder_;
  TickHistogram wakeup_error_;
  TickHistogram compute_;
  TickHistogram exchange_;
  rt::WordSeqlock<ServoSnapshot> published_;

  const bool has_watchdog_;  // the arm's own
  const bool has_motors_;
  OperatingState state_;
  HapticState arm_{};                // the newest sample
  coupling::ConstraintSet reply_{};  // scratch of one tick: clearing half a kilobyte costs time
  Force3 last_wish_{};               // held while no sample comes
  double freshness_gain_{1};
  std::uint64_t tick_{0};
  MonotonicTime previous_now_{};
  MonotonicTime last_write_{};   // that the bus took; before any, the first tick
  Duration away_since_write_{};  // by which ticks came late since then
  MonotonicTime latched_at_{};
  std::uint32_t interventions_{0};           // of the guard, as of this tick
  std::optional<MonotonicTime> zero_since_;  // since when the arm takes nothing but zero
  std::uint64_t zeros_taken_{0};             // since then
  bool is_driven_{false};                    // for the guard: it may hold a force
  std::uint32_t drive_{0};                   // the newest, for the guard; never 0 once driven
  HeldForce held_force_;
  bool was_active_{false};  // since the arm came
  bool was_pulled_{false};  // after it was driven, and not cleared since
  // Of this tick: what latched, what was unplugged, and what latched again after a clear.
  rt::StaticVector<Fault, 3> stops_;
  bool is_outage_over_{false};
  bool is_released_{false};
  bool is_let_go_{false};  // driven, but at zero force: the hand may have gone anywhere
  ServoSnapshot snapshot_{};
};

}  // namespace thimble::servo
