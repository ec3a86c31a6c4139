#pragma once

#include "hal/rt/annotations.hpp"

namespace thimble::rt {

// Tells another plane that something lies in a buffer for it. Implemented by
// linux::EventFd in the daemon and by the scheduler of virtual time in tests.
class WakeSignal {
 public:
  virtual ~WakeSignal() = default;
  // RT: THIMBLE_RT_IO, at most one non-blocking eventfd write.
  virtual void signal() noexcept = 0;
};

}  // namespace thimble::rt
