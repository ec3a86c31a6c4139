#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/arm_backend.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::plugin {

// Bus face of a simulated device at the end of a serial line: what its firmware does.
// The bus calls, in virtual time and from one thread, in every eighth of a USB frame, advance(t),
// and then, while somebody has it open, take() and give() for what the line carries in that time;
// see sim/bus/sim_serial_port.hpp.
//
// Thread: that of the bus. RT: everything but describe(): bounded, no allocation.
// Ownership: of the bus. Errors: none; bytes come from a driver and may be any.
class SimSerialModel {
 public:
  virtual ~SimSerialModel() = default;
  // Ids and names; address and kind are the bus's.
  [[nodiscard]] virtual bus::BusDeviceInfo describe() const = 0;
  // Rate of its line, or 0: a USB device that looks like one (CDC-ACM).
  [[nodiscard]] virtual std::uint32_t bit_per_s() const noexcept = 0;
  // Brings mechanics and firmware to `t` (never backwards).
  THIMBLE_RT virtual void advance(MonotonicTime t) noexcept = 0;
  // How many of `bytes`, which are not none, it has room for: the rest is offered again.
  THIMBLE_RT virtual std::size_t take(std::span<const std::uint8_t> bytes) noexcept = 0;
  // Fills `out` with what it has to say and returns how much that is.
  THIMBLE_RT virtual std::size_t give(std::span<std::uint8_t> out) noexcept = 0;
  // As SimUsbModel: until then it says nothing more unless it is sent something.
  [[nodiscard]] virtual MonotonicTime unchanged_until() const noexcept { return {}; }
  // Power cut and restored, as on unplug and replug: what is in volatile memory is lost.
  THIMBLE_RT virtual void power_cycle() noexcept = 0;
  [[nodiscard]] virtual ArmBackend* arm_backend() noexcept = 0;  // nullptr: not an arm
};

}  // namespace thimble::plugin
