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
  std::span<std::byte> memory;
  std::atomic<bool> is_gone{false};
};

// While it lives, this thread may touch the mapping. The first one of the process takes the signal;
// what is not of a guarded mapping goes to whoever had it before.
//
// Thread: made, used and ended on one; they nest like scopes, the innermost counts.
// Ownership: the mapping must outlive it.
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
