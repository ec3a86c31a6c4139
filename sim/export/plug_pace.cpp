#include "sim/export/plug_pace.hpp"

#include <algorithm>

namespace thimble::sim {

// Rounds that are run at once are late by that much, of which nothing is to be made up for.
PlugPace::PlugPace(VirtualClock& clock, Clock& machine, Plug& plug, Grain grain) noexcept
    : clock_(&clock),
      machine_(&machine),
      plug_(&plug),
      grain_(grain),
      brake_(clock, machine, kBrakeTolerance + grain.at_once) {}

MonotonicTime PlugPace::await_next() noexcept {
  const MonotonicTime last = clock_->now();
  const MonotonicTime needed = plug_->next_needed();
  if (!is_anchored_ || !hears_before(needed)) return needed;
  const Duration period = plug_->round_period();
  const auto passed = (machine_->now() - brake_.real_time_of(last)) / period;
  return std::min(needed, last + (passed + 1) * period);
}

// False: nobody has to be looked at before, and the model's slices until then are done.
bool PlugPace::hears_before(MonotonicTime needed) noexcept {
  const MonotonicTime last = clock_->now();
  const bool may_be_sooner = needed > last + plug_->round_period();
  const Duration slice = grain_.slice > Duration(0) ? grain_.slice : needed - last;
  for (MonotonicTime t = last + slice; t < needed; t = t + slice) {
    const MonotonicTime real = brake_.real_time_of(t);
    if (!may_be_sooner) {
      machine_->sleep_until(real);
    } else if (plug_->wait_for_kernel(real)) {
      return true;
    }
    plug_->advance_model(t);
  }
  return may_be_sooner && plug_->wait_for_kernel(brake_.real_time_of(needed));
}

void PlugPace::run_next() noexcept {
  if (grain_.at_once > Duration(0) && is_anchored_) return run_at_once();
  run_until(await_next());
  is_anchored_ = true;
}

void PlugPace::run_at_once() noexcept {
  const MonotonicTime end = clock_->now() + grain_.at_once;
  machine_->sleep_until(brake_.real_time_of(end));
  while (clock_->now() < end) run_until(std::min(plug_->next_needed(), end));
}

void PlugPace::run_until(MonotonicTime next) noexcept {
  plug_->leave_out_until(next);
  brake_.sleep_until(next);
}

}  // namespace thimble::sim
