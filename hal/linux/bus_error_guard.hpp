#pragma once

#include <atomic>
#include <cstddef>
#include <span>

namespace thimble::linux {

// A mapping whose memory may go away: of a file that was cut, or a PCI board that was pulled out.
// Touching it then is SIGBUS, which ends a process. Under a guard the memory becomes zeros that
// belong to nobody, and the guard says so
// (docs/decisions/0370-a-window-that-goes-away-is-no-end-of-the-process.md).
struct GuardedMapping {
  std::span<std::byte> memory;       // begins where a page does
  std::atomic<bool> is_gone{false};  // written by the signal's handler, never taken back
};

// While it lives, this thread may touch the mapping. The first one of the process takes the signal,
// for good; only a bus error outside the guarded mapping gives it back to whoever had it before,
// and from then on no guard helps.
//
// Thread: made, used and ended on one; they nest like scopes, the innermost counts.
// RT: not the first of the process, a system call behind a lock; after it two words of the thread.
// Ownership: the mapping must outlive it. Errors: none; where the signal cannot be taken, or zeros
// cannot be had, a bus error is what it is without a guard.
class BusErrorGuard {
 public:
  explicit BusErrorGuard(GuardedMapping& mapping) noexcept;
  ~BusErrorGuard();
  BusErrorGuard(const BusErrorGuard&) = delete;
  BusErrorGuard& operator=(const BusErrorGuard&) = delete;

 private:
  GuardedMapping* before_;
};

}  // namespace thimble::linux
