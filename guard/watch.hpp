#pragma once

#include <chrono>
#include <cstdint>

#include "hal/base/time.hpp"

namespace thimble::guard {

struct WatchSettings {
  // As long as an arm may be without a fresh command (DESIGN section 4, "servo late"). The guard
  // cuts at the same age at which the servo would stop by itself.
  Duration patience{std::chrono::milliseconds(20)};
  // Zero is written for so long, then the arm hears nothing and its own watchdog, if it has one,
  // takes the power away: as the servo does after a fault.
  Duration zero_for{std::chrono::milliseconds(100)};
};

// Decides when an arm must be let go: pure, no clock, no system call.
//
// Nothing is watched before the first beat: a servo that never ticked never asked for a force.
// When the beats stop, the arm is let go until they go on *and* the servo says that it has taken
// notice and written zero itself: what a stopped process had on its way to the arm may leave it
// after the guard's first zeros.
//
// Thread: one. Ownership: none. Errors: none; any numbers are allowed.
class Watch {
 public:
  explicit Watch(const WatchSettings& settings) noexcept : settings_(settings) {}

  // What is seen of the servo at `now`, which never goes backwards. True: write zero now.
  [[nodiscard]] bool look(MonotonicTime now, std::uint64_t beats,
                          std::uint32_t acknowledged) noexcept;
  // How often it began to let the arm go; what Heartbeat::interventions is to say.
  [[nodiscard]] std::uint32_t interventions() const noexcept { return interventions_; }

 private:
  WatchSettings settings_;
  std::uint64_t beats_{0};
  MonotonicTime last_beat_{};
  MonotonicTime zero_since_{};
  std::uint32_t interventions_{0};
  bool is_armed_{false};
  bool is_letting_go_{false};
};

}  // namespace thimble::guard
