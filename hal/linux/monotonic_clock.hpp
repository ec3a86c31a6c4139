#pragma once

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::linux {

// The machine's CLOCK_MONOTONIC.
//
// Thread: any; it has no state.
// RT: now() THIMBLE_RT (vDSO); sleep_until() THIMBLE_RT_IO, its one system call is
//     clock_nanosleep to an absolute time, repeated when a signal interrupts it.
//     Sleep on a SCHED_FIFO thread: others wake up to 50 µs late (timer slack).
class MonotonicClock final : public Clock {
 public:
  THIMBLE_RT [[nodiscard]] MonotonicTime now() const noexcept override;
  THIMBLE_RT_IO Duration sleep_until(MonotonicTime deadline) noexcept override;
};

}  // namespace thimble::linux
