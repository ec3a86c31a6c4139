#pragma once

#include <atomic>
#include <cstdint>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/time/event_queue.hpp"

namespace thimble::sim {

// Time that moves only when somebody sleeps: sleeping runs the events that are due.
//
// Thread: now() from any; sleep_until() and events() from the one thread that runs the clock.
// RT: now() THIMBLE_RT; sleep_until() as bounded as the events it runs. It makes no system call.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(MonotonicTime start = {}) noexcept : now_ns_(start.since_epoch.count()) {}

  THIMBLE_RT [[nodiscard]] MonotonicTime now() const noexcept override {
    return {Duration(now_ns_.load(std::memory_order_acquire))};
  }
  // Fires every event due at or before `deadline`, with now() at the event's time, then sets
  // now() to `deadline`. Returns 0; for a deadline in the past, how long ago it was.
  // Not to be called by an event: a nested sleep has no meaning, and ends the process.
  Duration sleep_until(MonotonicTime deadline) noexcept override;
  void run_for(Duration duration) noexcept { sleep_until(now() + duration); }

  [[nodiscard]] EventQueue& events() noexcept { return events_; }

 private:
  void set_now(MonotonicTime t) noexcept {
    now_ns_.store(t.since_epoch.count(), std::memory_order_release);
  }

  std::atomic<std::int64_t> now_ns_;
  bool is_running_{false};
  EventQueue events_;
};

}  // namespace thimble::sim
