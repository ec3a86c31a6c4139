#pragma once

#include "sim/export/plug.hpp"
#include "sim/time/real_time_brake.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

// Runs a plug at the machine's pace. Rounds in which nothing can happen pass without a wake-up, and
// without a look: until the model has something to say, the kernel says something, or a frame is
// over. What the kernel says is looked at in the next round, as if none were left out.
//
// With `at_once` > 0 rounds are run that much of time in one go, at its end: fewer wake-ups, for a
// machine to which they are dear. What the kernel says in the meantime is looked at then, too, as
// late as that; of reports through uhid, which nothing holds up, the newest counts for all of it.
// To the model each round is at its own time.
//
// With `slice` > 0 the model goes on whenever so much time has passed since the last round, in
// place of all at once in the next: it takes the processor for shorter at a time, for a machine on
// which others wait for it. What a device says, and when, stays the same.
//
// Thread: the one that runs the model's clock. RT: no; it sleeps. Ownership: all must outlive it.
class PlugPace {
 public:
  struct Grain {
    Duration at_once{};
    Duration slice{};  // one of them is 0
  };
  PlugPace(VirtualClock& clock, Clock& machine, Plug& plug, Grain grain) noexcept;
  // Sleeps until the next round that matters, and runs it; or those of `at_once`.
  void run_next() noexcept;

 private:
  [[nodiscard]] MonotonicTime await_next() noexcept;
  [[nodiscard]] bool hears_before(MonotonicTime needed) noexcept;
  void run_at_once() noexcept;
  void run_until(MonotonicTime next) noexcept;

  VirtualClock* clock_;
  Clock* machine_;
  Plug* plug_;
  Grain grain_;
  RealTimeBrake brake_;
  bool is_anchored_{false};
};

}  // namespace thimble::sim
