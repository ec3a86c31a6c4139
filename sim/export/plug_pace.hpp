#pragma once

#include "sim/export/plug.hpp"
#include "sim/time/real_time_brake.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

// Runs a plug at the machine's pace. Rounds in which nothing can happen pass without a wake-up, and
// without a look: until the model has something to say, the kernel says something, or a frame is
// over. What the kernel says is looked at in the next round, as if none were left out.
//
// Thread: the one that runs the model's clock. RT: no; it sleeps. Ownership: all must outlive it.
class PlugPace {
 public:
  PlugPace(VirtualClock& clock, Clock& machine, Plug& plug) noexcept;
  // Sleeps until the next round that matters, and runs it.
  void run_next() noexcept;

 private:
  [[nodiscard]] MonotonicTime await_next() noexcept;

  VirtualClock* clock_;
  Clock* machine_;
  Plug* plug_;
  RealTimeBrake brake_;
  bool is_anchored_{false};
};

}  // namespace thimble::sim
