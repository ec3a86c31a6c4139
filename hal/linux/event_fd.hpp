#pragma once

#include <cstdint>
#include <memory>

#include "hal/base/result.hpp"
#include "hal/rt/wake_signal.hpp"

namespace thimble::linux {

// Wakes a poll loop from the servo thread.
//
// Thread: signal() from any; drain() from the thread that polls fd().
// RT: signal() THIMBLE_RT_IO: one non-blocking write. Ownership: owns the descriptor.
class EventFd final : public rt::WakeSignal {
 public:
  // System where the process or the machine has no descriptor left.
  static Result<std::unique_ptr<EventFd>> create();
  ~EventFd() override;
  EventFd(const EventFd&) = delete;
  EventFd& operator=(const EventFd&) = delete;

  THIMBLE_RT_IO void signal() noexcept override;
  // Readable from a signal() to the next drain().
  [[nodiscard]] int fd() const noexcept { return fd_; }
  // Number of signals since the last drain; 0 when there was none. Never waits.
  std::uint64_t drain() noexcept;

 private:
  explicit EventFd(int fd) noexcept : fd_(fd) {}
  int fd_;
};

}  // namespace thimble::linux
