#pragma once

#include "daemon/coupling/messages.hpp"
#include "hal/base/result.hpp"

namespace thimble::coupling {

// The world half of a coupling scheme for one arm: answers each hand sample with constraints.
//
// Thread: the world's thread (net plane). Not RT, but answer() neither allocates nor blocks.
// Ownership: the world it talks to must outlive it. Frame: the world's.
// Errors: open() says why the world refuses the hand; answer() has none: of a sample that cannot be
//         answered it gives the last set again, its number included.
class WorldCoupling {
 public:
  virtual ~WorldCoupling() = default;
  // A hand appears (first sample of a session): the ghost starts at the hand where that is
  // free, else at the nearest free place. Session numbers never repeat.
  [[nodiscard]] virtual Result<void> open(const HandSample& first) = 0;
  // `dt` since the previous answer of this session, > 0; bounds the speed of push-out.
  [[nodiscard]] virtual ConstraintSet answer(const HandSample& sample, Duration dt) noexcept = 0;
  // Of the cells that it tells of (MapNews); 0: it tells of none.
  [[nodiscard]] virtual std::uint64_t cells_epoch() const noexcept { return 0; }
  virtual void close() noexcept = 0;  // the hand is gone; the probe leaves the world
};

}  // namespace thimble::coupling
