#pragma once

// SCHED_FIFO priorities, all in one place, for what they are is an order: a guard that waits for a
// servo or a bus that spins gives nobody zero force. sched(7): 1 to 99.
namespace thimble {

// Ours: above audio servers (83-88 with rtkit, but unusual beside a servo) only on purpose.
inline constexpr int kServoPriority = 80;
inline constexpr int kMaxServoPriority = 89;  // of servos, their buses and the safety lines
inline constexpr int kGuardPriority = 90;
// Below 99, which the kernel's own watchdog and migration threads have.
inline constexpr int kMaxPriority = 98;
static_assert(kServoPriority <= kMaxServoPriority && kMaxServoPriority < kGuardPriority &&
              kGuardPriority <= kMaxPriority);

}  // namespace thimble
