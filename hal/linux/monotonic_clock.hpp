#pragma once

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::linux {

// The machine's CLOCK_BOOTTIME: CLOCK_MONOTONIC, and the time in which the machine was suspended
// besides (clock_gettime(2)). So a servo, a guard or a link sees that it was away, and no force
// from before is taken up again as if nothing had been (decision 0410).
//
// Thread: any; it has no state, and owns nothing. Errors: none: the kernel has had this clock since
//     2.6.39.
// RT: now() THIMBLE_RT (vDSO); sleep_until() THIMBLE_RT_IO, its one system call is
//     clock_nanosleep to an absolute time, repeated when a signal interrupts it.
//     Sleep on a SCHED_FIFO thread: others wake up to 50 µs late (timer slack).
class MonotonicClock final : public Clock {
 public:
  THIMBLE_RT [[nodiscard]] MonotonicTime now() const noexcept override;
  THIMBLE_RT_IO Duration sleep_until(MonotonicTime deadline) noexcept override;
};

}  // namespace thimble::linux
