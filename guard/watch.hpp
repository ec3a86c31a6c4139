#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "hal/base/time.hpp"

namespace thimble::guard {

struct WatchSettings {
  // As long as an arm may be without a fresh command (DESIGN section 4, "servo late"). The guard
  // cuts at the same age at which the servo would stop by itself; it counts from the beginning of
  // the last tick that came to its end.
  Duration patience{std::chrono::milliseconds(20)};
  // Zero is written for so long after the first that the arm took (over hiddev: that the kernel
  // took, which does not tell what the arm refuses); then it hears nothing and its
  // own watchdog, if it has one, takes the power away: as the servo does after a fault, and for as
  // long as that (ServoSettings::zero_before_silence). Ours.
  Duration zero_for{std::chrono::milliseconds(100)};
  // An arm that takes no zero for so long takes none, though its node does not say that it is gone.
  // Ours, and no shorter than what the kernel may keep one write over hiddev for: 10 s, and before
  // them 10 s of the daemon's that was under way (decision 0488).
  Duration gives_up_after{std::chrono::seconds(25)};
  // Of zeros, while they are written. Ours: two of a full-speed device's frames.
  Duration zero_every{std::chrono::milliseconds(2)};
  // At an arm that is not driven. Ours: half of the patience, so that the first force of all is
  // known before it can be too old.
  Duration idle_look_every{std::chrono::milliseconds(10)};
  // So long before a beat is too old it is looked whether there is a newer one. Ours: at servos of
  // 500 Hz, 1, 2 and 4 kHz that is 0.1 ms beside each tick or more, which a guard that woke with
  // it would hold up.
  Duration looks_ahead{std::chrono::microseconds(400)};
};

// Decides when an arm must be let go: pure, no clock, no system call.
//
// Only an arm that is driven is watched: bytes for nobody could fall into a firmware that is being
// uploaded. When the beats stop, zero is written until the arm has taken it for a while; when they
// go on, until the servo says that it took the force away itself: what a stopped process had on its
// way to the arm may leave it after the guard's first zeros.
//
// Thread: one. RT: bounded; no system call, allocation or lock. Ownership: none. Errors: none; any
// numbers are allowed.
class Watch {
 public:
  explicit Watch(const WatchSettings& settings) noexcept : settings_(settings) {}

  // What is seen of the servo at `now`, which never goes backwards; `beat_at`: its last beat, by
  // the same clock; `drive`: rt::Heartbeat::drive. True: write zero now, and say with wrote() what
  // became of it.
  [[nodiscard]] bool look(MonotonicTime now, MonotonicTime beat_at, std::uint32_t drive) noexcept;
  // The same when the daemon is gone: what it said last of its arm stays.
  [[nodiscard]] bool look_alone(MonotonicTime now, bool was_driven) noexcept;
  // `now`: when it had been written.
  void wrote(MonotonicTime now, bool is_taken) noexcept;
  // When to look again, after one at `now`: shortly before the last beat that was seen is too old,
  // or when it is; no beat after it can be so sooner. Later than `now`.
  [[nodiscard]] MonotonicTime next_look(MonotonicTime now) const noexcept;

  // How often it began to let the arm go.
  [[nodiscard]] std::uint32_t interventions() const noexcept { return interventions_; }

 private:
  [[nodiscard]] bool must_write(MonotonicTime now) const noexcept;

  WatchSettings settings_;
  std::optional<MonotonicTime> looked_at_;
  MonotonicTime seen_{};       // as the servo said
  MonotonicTime last_beat_{};  // as it counts here
  std::optional<MonotonicTime> alone_since_;
  std::optional<MonotonicTime> taken_since_;  // the first zero of this stop that the arm took
  std::uint32_t interventions_{0};
  std::uint32_t drive_{0};
  bool is_letting_go_{false};
};

}  // namespace thimble::guard
