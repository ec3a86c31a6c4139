#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/phantom/phantom_codec.hpp"
#include "hal/base/io_status.hpp"
#include "hal/base/time.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::phantom {

struct ControllerReport {
  DeviceReport values;
  MonotonicTime arrived_at{};
  std::uint64_t sequence{0};  // +1 for every report that arrived, read or not
};

// What the driver says to the controller and hears of it, in amperes and counts: one transport with
// the codec of its firmware. What an arm is, nobody here knows.
//
// Thread, RT, Errors: read(), write_currents() and zero_counters() as HapticDevice's read() and
// write(); the rest as HapticDevice. Ownership: owns its bus device.
class ControllerLink {
 public:
  virtual ~ControllerLink() = default;
  // The newest report since the last call. Ok, NoData, Disconnected; ProtocolError (counted as
  // malformed here) when only what cannot be believed has come.
  THIMBLE_RT_IO virtual IoStatus read(ControllerReport& out) noexcept = 0;
  // The caller has held them within the amplifier. A link bounds them to what its messages may say:
  // HidLink to 32.767 A either way, TextLink to the full scale. What becomes of a Backlogged
  // command: HidLink's waits in the bus's mailbox, TextLink's is dropped.
  THIMBLE_RT_IO virtual IoStatus write_currents(
      const std::array<double, 3>& current_a) noexcept = 0;
  // Makes the counters zero where the arm is, and lowers the flag of the calibration button.
  THIMBLE_RT_IO virtual IoStatus zero_counters() noexcept = 0;
  // The button's press has made the counters zero already, whatever the host wanted.
  [[nodiscard]] virtual bool is_zeroed_by_press() const noexcept = 0;
  // The arm stands where a press of the button, now, would not be seen.
  [[nodiscard]] virtual bool is_press_unseen() const noexcept = 0;
  // The controller lets go by itself after so long without a message of ours.
  [[nodiscard]] virtual Duration watchdog() const noexcept = 0;
  [[nodiscard]] virtual DeviceCounters counters() const noexcept = 0;
  [[nodiscard]] virtual ZeroCommand zero_command() const noexcept = 0;
  // Why nothing that comes can be believed; empty: it can.
  [[nodiscard]] virtual std::string_view trouble() const noexcept = 0;
};

}  // namespace thimble::phantom
