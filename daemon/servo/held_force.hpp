#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// Whether the arm's motors may still hold a force, as far as its host can know: from the first
// command with a force until the bus took nothing but zero for `settled`, three times at least, and
// the arm said something since. Three, since Ok of a bus may tell of what was sent before: the
// first of the force before the last, the second of the last one.
//
// Of an arm that is lost, or deaf, or silent it stays as it was: nobody knows.
//
// Thread: servo. RT: THIMBLE_RT. A value.
class HeldForce {
 public:
  explicit HeldForce(Duration settled) noexcept : settled_(settled) {}

  // Once a tick, before note_command(): whether a new sample came in it.
  THIMBLE_RT void note_sample(bool is_fresh) noexcept {
    has_answered_ = has_answered_ || (is_fresh && zeros_ >= kZerosOfOneThatArrived);
  }
  // Once for each command that was given to the bus.
  THIMBLE_RT void note_command(MonotonicTime now, bool is_zero, bool is_taken) noexcept {
    if (!is_zero) return begin();
    if (!may_hold_ || !is_taken) return;
    if (!zero_since_) zero_since_ = now;
    ++zeros_;
    const bool has_arrived = zeros_ >= kZerosOfOneThatArrived && now - *zero_since_ >= settled_;
    if (has_arrived && has_answered_) may_hold_ = false;
  }
  // The arm is gone: what was under way arrived or did not.
  THIMBLE_RT void note_loss() noexcept {
    if (may_hold_) begin();
  }
  [[nodiscard]] bool may_hold() const noexcept { return may_hold_; }

 private:
  static constexpr std::uint64_t kZerosOfOneThatArrived = 3;

  THIMBLE_RT void begin() noexcept {
    may_hold_ = true;
    has_answered_ = false;
    zeros_ = 0;
    zero_since_.reset();
  }

  Duration settled_;
  bool may_hold_{false};
  bool has_answered_{false};
  std::uint64_t zeros_{0};
  std::optional<MonotonicTime> zero_since_{};
};

}  // namespace thimble::servo
