#include "hal/linux/realtime_process.hpp"

#include <utility>

#include "hal/linux/memory_lock.hpp"

namespace thimble::linux {

RealtimeProcess::RealtimeProcess() {
  // With big stacks, locking would cost more memory than it is worth.
  Result<void> locked = set_default_thread_stack(kThreadStackBytes);
  if (locked.has_value()) locked = lock_memory();
  report_.has_memory_lock = locked.has_value();
  if (!locked.has_value()) report_.missing.push_back(locked.error().message);
  const Result<void> refused = refuse_huge_pages();
  if (!refused.has_value()) report_.missing.push_back(refused.error().message);

  Result<CpuDmaLatency> latency = CpuDmaLatency::hold();
  report_.has_dma_latency = latency.has_value();
  if (latency.has_value()) {
    latency_.emplace(std::move(latency.value()));
  } else {
    report_.missing.push_back(latency.error().message);
  }
}

}  // namespace thimble::linux
