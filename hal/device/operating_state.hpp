#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace thimble {

// The life of an arm (DESIGN: lifecycle). In Inactive the servo reads and publishes and
// writes zero; only Active drives.
enum class OperatingState : std::uint8_t {
  Discovered,
  Opened,
  Configured,
  Calibrating,
  Inactive,
  Active,
  Fault,
  Lost,
};
inline constexpr std::size_t kOperatingStateCount = 8;

enum class LifecycleEvent : std::uint8_t {
  Open,       // the bus device was opened
  Configure,  // parameters accepted
  Calibrate,  // waiting for a reference: the person is told what to do
  Homed,      // the reference is known
  Activate,   // needs is_homed
  Deactivate,
  LoseHome,    // the reference is gone (device reset): calibrate again
  Fail,        // a fault is latched
  ClearFault,  // explicit, by a person; the latch has agreed
  Unplug,
  Return,  // the same device is back
  Close,
};
inline constexpr std::size_t kLifecycleEventCount = 12;

std::string_view to_string(OperatingState state) noexcept;
std::string_view to_string(LifecycleEvent event) noexcept;

// The state after `event`, or nothing where the table has no such transition. Pure.
[[nodiscard]] std::optional<OperatingState> next_state(OperatingState state,
                                                       LifecycleEvent event) noexcept;

}  // namespace thimble
