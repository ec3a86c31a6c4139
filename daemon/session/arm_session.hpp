#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/arm_link.hpp"
#include "daemon/coupling/steady_force.hpp"
#include "daemon/devices/device_executor.hpp"
#include "daemon/devices/replaceable_device.hpp"
#include "daemon/servo/flight_file.hpp"
#include "daemon/servo/servo_loop.hpp"
#include "daemon/session/arm_opening.hpp"
#include "daemon/session/guarded_arm.hpp"
#include "daemon/session/retry_pace.hpp"
#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/driver_registry.hpp"

namespace thimble::session {

// What a session runs on; everything must outlive it.
struct ArmSessionParts {
  bus::BusEnumerator& buses;
  const plugin::DriverRegistry& drivers;
  coupling::ArmLink& link;
  devices::DeviceExecutor& executor;    // opens and closes the arm while the session lives
  Clock& clock;                         // of the servo and of the arm's bus
  const Clock& stopwatch;               // measures only
  double cell_m{0};                     // of the world at the other end, where it is known
  devices::ArmGuards* guards{nullptr};  // nullptr: an arm that needs a guard is refused
  servo::EntryBox entry{};              // of that world, where it is known
};

// One stop of the servo, to be written to a file by whoever may block.
struct Recording {
  servo::FlightHeader header;
  std::vector<servo::ServoFrame> frames;
};

// One arm of the configuration, opened, with its coupling and its servo; it runs wherever its
// loop is ticked: on a real-time thread in the daemon, in virtual time in tests and the lab.
//
// Thread: loop() is ticked by the servo thread; all else belongs to one control thread.
class ArmSession {
 public:
  // Opens it by parts.executor and waits for that. Errors: as open_and_wait(),
  // make_limiter_settings() and GuardedArm::begin(), with the arm's name in front.
  [[nodiscard]] static Result<std::unique_ptr<ArmSession>> create(const config::ArmConfig& arm,
                                                                  const config::ServoConfig& servo,
                                                                  const ArmSessionParts& parts);
  // The same for an arm that was opened before.
  [[nodiscard]] static Result<std::unique_ptr<ArmSession>> create(const config::ArmConfig& arm,
                                                                  const config::ServoConfig& servo,
                                                                  const ArmSessionParts& parts,
                                                                  Opened opened);
  // The same for an arm that cannot be had now: Lost, for as long as the session lives, without
  // motors and so without limits to be guessed. Whoever finds the arm makes a session of it.
  [[nodiscard]] static Result<std::unique_ptr<ArmSession>> create_lost(
      const config::ArmConfig& arm, const config::ServoConfig& servo, const ArmSessionParts& parts);

  [[nodiscard]] servo::ServoLoop& loop() noexcept { return *loop_; }
  [[nodiscard]] servo::ServoControls& controls() noexcept { return controls_; }
  // What the arm is made to wish instead of what its world says.
  [[nodiscard]] coupling::SteadyForce& steady_force() noexcept { return *coupling_; }
  // Tunes the wave impedance of its scheme. False: it has none.
  bool set_impedance(Damping b) noexcept { return coupling_->set_impedance(b); }
  [[nodiscard]] const config::ArmConfig& config() const noexcept { return arm_; }
  [[nodiscard]] const devices::ReplaceableDevice& device() const noexcept { return device_; }
  // At what its arm is driven; nothing until that has come, where the configuration says no rate.
  [[nodiscard]] std::optional<double> rate_hz() const noexcept;
  // The newest state; what was known before when the servo wrote all the while.
  [[nodiscard]] const servo::ServoSnapshot& snapshot();

  // The oldest stop that waits to be written, if any; two may wait.
  [[nodiscard]] std::optional<Recording> take_recording();
  // Hot-plug: `event` concerns some device; when ours arrives it is looked for at once.
  void on_bus_event(const bus::BusEvent& event);
  // Never waits for an arm: posts a search and looks, at each call, whether its answer is there, so
  // that a lost arm is back some calls after it could be had.
  // Opens a lost arm again as soon as it can be had, trying less and less often, and puts away
  // what the servo has let go of. `now` is the caller's own time. Errors: the arm is there, but
  // this try could not open it or does not end, or another device stands in its place: that is left
  // alone.
  Result<void> follow(MonotonicTime now);
  // Why a returned arm is still lost, for a person; empty when nothing is wrong.
  [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }

 private:
  ArmSession(const config::ArmConfig& arm, const ArmSessionParts& parts,
             std::unique_ptr<HapticDevice> device, std::unique_ptr<coupling::ArmCoupling> coupling);
  // With coupling and limits for `device`, but no loop yet. Errors: those of arm_settings.hpp.
  [[nodiscard]] static Result<std::unique_ptr<ArmSession>> make(
      const config::ArmConfig& arm, const config::ServoConfig& servo, const ArmSessionParts& parts,
      std::unique_ptr<HapticDevice> device);
  void make_loop(bool is_lost);

  [[nodiscard]] bool is_lost_for_servo();
  // A search that does not end: what the status says of it, and once what the log says.
  Result<void> note_lateness(MonotonicTime now);
  Result<void> take_back(OpenOutcome outcome);
  // Takes it, unless there is an error.
  Result<void> offer(std::unique_ptr<HapticDevice>& device, const std::string& refusal);

  config::ArmConfig arm_;
  ArmSessionParts parts_;
  devices::ReplaceableDevice device_;
  std::unique_ptr<coupling::SteadyForce> coupling_;
  servo::ServoControls controls_;
  GuardedArm guard_;
  servo::ServoSettings settings_;
  bool is_rate_known_{true};
  std::unique_ptr<servo::ServoLoop> loop_;
  servo::ServoSnapshot snapshot_{};
  std::string trouble_;
  RetryPace pace_;       // of a lost arm
  OpenRequest request_;  // for the arm that the session was made for, should it be lost
  ArmOpener opener_;
  std::uint64_t offered_at_tick_{0};
};

}  // namespace thimble::session
