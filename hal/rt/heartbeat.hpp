#pragma once

#include <atomic>
#include <cstdint>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::rt {

// Of one arm's servo, in memory that its guard shares: how the guard sees that the servo lives,
// and how the servo learns that the guard let its arm go. Zero bytes are a fresh one.
//
// Thread: each field has one writer, named beside it; any thread of both processes reads.
// RT: plain atomics. Ownership: of whoever mapped the memory.
// Errors: what the other side writes is hostile at worst: numbers are compared, never used as
//     sizes or places.
struct Heartbeat {
  // Servo: when its last tick began, unless no command has left for 20 ms; ns of the clock that
  // linux::MonotonicClock reads. Both processes read the same one, so that an age is exact however
  // seldom somebody looks.
  std::atomic<std::int64_t> beat_at_ns{0};
  // Servo: which drive of the arm this is, from 1, from before its first force is written until the
  // arm has taken nothing but zero for a while; 0 between. Each has another number than the one
  // before, so that a guard that looked away meanwhile knows that the force was taken away.
  std::atomic<std::uint32_t> drive{0};
  std::atomic<std::uint32_t> interventions{0};  // guard: +1 whenever it began to let the arm go
  THIMBLE_RT void beat(MonotonicTime now) noexcept {
    beat_at_ns.store(now.since_epoch.count(), std::memory_order_release);
  }
};
static_assert(std::atomic<std::int64_t>::is_always_lock_free);
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
static_assert(sizeof(Heartbeat) == 16, "two processes agree on it");

}  // namespace thimble::rt
