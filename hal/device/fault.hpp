#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble {

enum class FaultCode : std::uint8_t {
  None,
  NonFiniteForce,   // a coupling produced NaN or infinity
  NonFiniteState,   // a driver produced NaN or infinity
  Overspeed,        // tip faster than the limit
  StaleSample,      // no fresh sample from the arm for too long
  MissedExchanges,  // the leaky bucket is full
  Disconnected,     // the bus lost the device
  ServoLate,        // the servo did not run for so long that the arm had no fresh command
  Estop,
  LostReference,   // the arm lost its calibration while it was driven
  GuardLost,       // the arm's guard ended while it was driven
  CommandTimeout,  // the arm, or its bus, took no command for too long
};
inline constexpr std::size_t kFaultCodeCount = 12;

// Short name for status and recordings, e.g. "overspeed".
std::string_view to_string(FaultCode code) noexcept;
// One sentence for a person: what happened and what to do.
std::string_view explain(FaultCode code) noexcept;

struct Fault {
  FaultCode code{FaultCode::None};
  MonotonicTime at{};
  std::uint64_t tick{0};
  std::uint32_t number{0};  // 1 for the first that the latch took; a request to clear names it
};

// What became of a request to clear a fault.
enum class ClearOutcome : std::uint8_t {
  None,            // none was judged yet
  Cleared,         // the fault that it named is latched no more
  NotLatched,      // that fault is not the latched one
  InputUnhealthy,  // a safety input is not healthy; the request is spent
};

// First fault wins and stays until cleared.
//
// Thread: latch(), clear(), fault() from the servo thread; code() from any thread.
// RT: all THIMBLE_RT.
class FaultLatch {
 public:
  // Returns true when this call latched; a later fault changes nothing.
  THIMBLE_RT bool latch(FaultCode code, MonotonicTime at, std::uint64_t tick) noexcept;
  // Call it once for each request. It clears the fault with that number and no other: a request
  // that was made for an earlier fault cannot clear a later one, however late it comes.
  THIMBLE_RT ClearOutcome clear(std::uint32_t number, bool inputs_healthy) noexcept;

  [[nodiscard]] const Fault& fault() const noexcept { return fault_; }
  [[nodiscard]] bool is_latched() const noexcept { return fault_.code != FaultCode::None; }
  [[nodiscard]] FaultCode code() const noexcept { return code_.load(std::memory_order_relaxed); }

 private:
  Fault fault_{};
  std::uint32_t latched_{0};  // faults so far
  std::atomic<FaultCode> code_{FaultCode::None};
};

}  // namespace thimble
