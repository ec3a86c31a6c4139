#include "sim/export/plug_pace.hpp"

#include <algorithm>

namespace thimble::sim {

// Rounds that are run at once are late by that much, of which nothing is to be made up for.
PlugPace::PlugPace(VirtualClock& clock, Clock& machine, Plug& plug, Duration at_once) noexcept
    : clock_(&clock),
      machine_(&machine),
      plug_(&plug),
      at_once_(at_once),
      brake_(clock, machine, kBrakeTolerance + at_once) {}

MonotonicTime PlugPace::await_next() noexcept {
  const Duration period = plug_->round_period();
  const MonotonicTime last = clock_->now();
  const MonotonicTime needed = plug_->next_needed();
  if (!is_anchored_ || needed <= last + period) return needed;
  if (!plug_->wait_for_kernel(brake_.real_time_of(needed))) return needed;
  const auto passed = (machine_->now() - brake_.real_time_of(last)) / period;
  return std::min(needed, last + (passed + 1) * period);
}

void PlugPace::run_next() noexcept {
  if (at_once_ > Duration(0) && is_anchored_) return run_at_once();
  run_until(await_next());
  is_anchored_ = true;
}

void PlugPace::run_at_once() noexcept {
  const MonotonicTime end = clock_->now() + at_once_;
  machine_->sleep_until(brake_.real_time_of(end));
  while (clock_->now() < end) run_until(std::min(plug_->next_needed(), end));
}

void PlugPace::run_until(MonotonicTime next) noexcept {
  plug_->leave_out_until(next);
  brake_.sleep_until(next);
}

}  // namespace thimble::sim
