#pragma once

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/messages.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// The arm end of a link, as the servo sees it: mailboxes, whatever carries them.
//
// Thread: the servo thread. RT: all THIMBLE_RT but send(), which is THIMBLE_RT_IO (at most
// one non-blocking eventfd write to wake the net plane).
// Ownership: samples and replies are copied; a link outlives the servo loop that it is given to.
// Errors: none; a link that is down shows in quality(), and what it cannot carry is not sent.
class ArmLink {
 public:
  virtual ~ArmLink() = default;
  THIMBLE_RT_IO virtual void send(const HandSample& sample) noexcept = 0;
  // The newest accepted reply since the last call. False: none, `out` untouched.
  THIMBLE_RT virtual bool receive(ConstraintSet& out) noexcept = 0;
  [[nodiscard]] THIMBLE_RT virtual LinkQuality quality() const noexcept = 0;
};

}  // namespace thimble::coupling
