#include "sim/time/real_time_brake.hpp"

namespace thimble::sim {

Duration RealTimeBrake::sleep_until(MonotonicTime deadline) noexcept {
  if (!is_anchored_) {
    anchor_virtual_ = virtual_->now();
    anchor_real_ = real_->now();
    is_anchored_ = true;
  }
  if (deadline <= virtual_->now()) return virtual_->sleep_until(deadline);

  const MonotonicTime deadline_real = anchor_real_ + (deadline - anchor_virtual_);
  const Duration lateness = real_->sleep_until(deadline_real);
  if (lateness > tolerance_) {
    anchor_virtual_ = deadline;
    anchor_real_ = deadline_real + lateness;
    total_delay_ns_.fetch_add(lateness.count(), std::memory_order_relaxed);
    reanchors_.fetch_add(1, std::memory_order_relaxed);
  }
  virtual_->sleep_until(deadline);
  return lateness;
}

}  // namespace thimble::sim
