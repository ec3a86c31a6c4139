#pragma once

#include <optional>

#include "hal/linux/cpu_dma_latency.hpp"
#include "hal/linux/realtime_report.hpp"

namespace thimble::linux {

// What real time needs of the whole process: small stacks, locked memory, shallow idle.
//
// Thread: made at start-up before any other thread; lives as long as the servo threads. Not RT.
// Ownership: of the file by which the machine stays awake (CpuDmaLatency); the rest is the
// process's. Errors: none; report() says what is missing, RealtimeThread::start() decides.
class RealtimeProcess {
 public:
  RealtimeProcess();
  // has_memory_lock and has_dma_latency; the thread's rights are not known yet.
  [[nodiscard]] const RealtimeReport& report() const noexcept { return report_; }

 private:
  RealtimeReport report_;
  std::optional<CpuDmaLatency> latency_;
};

}  // namespace thimble::linux
