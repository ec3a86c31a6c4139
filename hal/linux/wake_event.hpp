#pragma once

#include <memory>
#include <utility>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/rt/wake_signal.hpp"

namespace thimble::linux {

// Wakes a thread that waits for nothing else, which takes it one system call a signal; to poll an
// EventFd and to drain it are two. Signals since the last wait are one.
//
// Thread: signal() from any; the waits from one thread.
// RT: signal() THIMBLE_RT_IO: one eventfd write, which would wait only behind 2^64-2 signals that
// nobody heard; the waits are for threads of a bus.
// Ownership: owns the descriptor.
class WakeEvent final : public rt::WakeSignal {
 public:
  // System where the process or the machine has no descriptor left.
  static Result<std::unique_ptr<WakeEvent>> create();

  THIMBLE_RT_IO void signal() noexcept override;
  // Until somebody signals, or at once where that was done since the last wait.
  void wait() noexcept;
  // The same for no longer than `most`, 0 or less: not at all. Whether somebody did.
  bool wait_at_most(Duration most) noexcept;

 private:
  explicit WakeEvent(Descriptor event) noexcept : event_(std::move(event)) {}
  Descriptor event_;
};

}  // namespace thimble::linux
