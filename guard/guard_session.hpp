#pragma once

#include <memory>

#include "guard/handover.hpp"
#include "guard/shared_page.hpp"
#include "guard/watch.hpp"
#include "guard/zero_writer.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::guard {

// The first packet follows the connection at once; a peer that sends none is no daemon. Ours: as
// long as a daemon waits for its guard's answer (GuardedArm::kPatience).
inline constexpr int kHandoverTimeout_ms = 5000;
// What a guard answers when it watches: from then on the arm may be driven.
inline constexpr char kWatching = 'W';

// The guard of one arm, from its handover to the end of the connection.
//
// Thread: one, SCHED_FIFO above the servos where it may be: a servo that spins must not starve it.
// RT: not accept(). step() and await_next() allocate nothing and take no lock; all that they wait
//     for is the kernel.
// Ownership: `socket` and `calls` are the caller's and outlive it.
class GuardSession {
 public:
  // Waits for the handover and answers it. Errors: as receive_handover() and SharedPage::map().
  [[nodiscard]] static Result<GuardSession> accept(int socket, int timeout_ms,
                                                   linux::DeviceCalls& calls);

  // One look; where zero is to be written it blocks as ZeroWriter::write() does.
  // False: the connection has ended, and nothing is left to do. Of an arm that was driven that
  // comes 100 ms after the first zero that it took then, 25 s after the end (WatchSettings), or
  // with the first zero that it did not take because it was gone.
  [[nodiscard]] bool step(const Clock& clock) noexcept;
  // Until the next look is due, or the connection ends; after a step.
  void await_next(Clock& clock) noexcept;

  [[nodiscard]] std::uint32_t interventions() const noexcept { return watch_.interventions(); }
  [[nodiscard]] const ZeroWriter& zeros() const noexcept { return writer_; }

 private:
  GuardSession(int socket, Received received, SharedPage page, linux::DeviceCalls& calls) noexcept;
  [[nodiscard]] bool has_ended() noexcept;

  int socket_;
  SharedPage page_;
  ZeroWriter writer_;
  Watch watch_{WatchSettings{}};
  bool is_ended_{false};
};

}  // namespace thimble::guard
