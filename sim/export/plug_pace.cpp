#include "sim/export/plug_pace.hpp"

#include <algorithm>

namespace thimble::sim {

PlugPace::PlugPace(VirtualClock& clock, Clock& machine, Plug& plug) noexcept
    : clock_(&clock), machine_(&machine), plug_(&plug), brake_(clock, machine) {}

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
  const MonotonicTime next = await_next();
  plug_->leave_out_until(next);
  brake_.sleep_until(next);
  is_anchored_ = true;
}

}  // namespace thimble::sim
