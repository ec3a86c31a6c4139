#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "daemon/config/config.hpp"
#include "daemon/devices/device_executor.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/driver_registry.hpp"

namespace thimble::session {

// A real arm of the configuration, and where to look for it; what is pointed at outlives a request.
struct OpenRequest {
  config::ArmConfig arm;
  bus::BusEnumerator* buses{nullptr};
  const plugin::DriverRegistry* drivers{nullptr};
  const Clock* clock{nullptr};               // of the servo and of the arm's bus
  std::optional<bus::BusDeviceInfo> left{};  // the arm that left: no other one is opened
  bool probe_only{false};                    // only look: open nothing
};

// What came of a request.
struct NotThere {
  Error why;  // and what there is instead
};
struct Probed {};  // it is there, and nothing was opened: no more was asked for
struct Refused {
  Error why;  // it is there, or may be, and cannot be had
};
struct Opened {
  bus::BusDeviceInfo info;
  std::unique_ptr<HapticDevice> device;  // never nullptr
};
using OpenOutcome = std::variant<NotThere, Probed, Refused, Opened>;
// Of one that was to be opened. Errors: why it was not.
[[nodiscard]] Result<Opened> opened_of(OpenOutcome outcome);

// Thread: any, but one at a time for each arm; waits for the kernel. Errors, as
// devices::find_device(), check_same_device() and open_arm(); System where a bus, a driver or a
// plugin threw something.
[[nodiscard]] OpenOutcome open_now(const OpenRequest& request);

// The same by `executor`, for who may wait, as at a start: no closing of the same arm is under way
// meanwhile. Gives up after kStartPatience, Timeout, and what comes of it later is closed. `clock`
// is of who waits.
[[nodiscard]] OpenOutcome open_and_wait(const OpenRequest& request,
                                        devices::DeviceExecutor& executor, Clock& clock);

// Ours: of a start, for each arm; longer than all but a port that hangs takes.
inline constexpr Duration kStartPatience = std::chrono::seconds(5);

// One search after the other, none of which its owner waits for
// (docs/decisions/0389-the-control-plane-waits-for-no-kernel.md).
//
// Thread: control thread. Ownership: `executor` must outlive it; what nobody took is closed by
// that.
class ArmOpener {
 public:
  explicit ArmOpener(devices::DeviceExecutor& executor) : executor_(executor) {}
  ~ArmOpener();
  ArmOpener(const ArmOpener&) = delete;
  ArmOpener& operator=(const ArmOpener&) = delete;

  [[nodiscard]] bool is_under_way() const noexcept { return slot_ != nullptr; }
  // Not while one is under way. `now`, here and below, is the owner's own time.
  void begin(OpenRequest request, MonotonicTime now);
  // What came of it, once.
  [[nodiscard]] std::optional<OpenOutcome> take();
  // Why the arm is not there, for a person, once the search under way has lasted kLong; else empty.
  [[nodiscard]] std::string lateness(MonotonicTime now) const;
  // The same for a log: an error once for each search that has become late. Errors: Timeout.
  Result<void> tell_lateness(MonotonicTime now);
  // Of no use after all: close it.
  void give_back(OpenOutcome outcome);

  // Ours: what opens well takes less, a Falcon's firmware included.
  static constexpr Duration kLong = std::chrono::seconds(2);

 private:
  struct Slot {
    std::atomic<bool> is_done{false};
    std::optional<OpenOutcome> outcome;
  };
  devices::DeviceExecutor& executor_;
  std::shared_ptr<Slot> slot_;
  std::string device_;  // of the newest search
  MonotonicTime begun_at_{};
  bool has_told_{false};
};

}  // namespace thimble::session
