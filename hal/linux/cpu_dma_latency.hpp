#pragma once

#include <utility>

#include "hal/base/result.hpp"

namespace thimble::linux {

// Keeps the CPUs out of deep idle states, which delay the interrupt of a USB transfer, for as
// long as it lives: it asks for a latency of 0 µs (Linux:
// Documentation/power/pm_qos_interface.rst).
//
// Thread: control thread. Not RT. Ownership: the request ends with the object.
class CpuDmaLatency {
 public:
  // Permission, NotFound or System, naming the right and the cure. Another `node` is for tests.
  static Result<CpuDmaLatency> hold(const char* node = "/dev/cpu_dma_latency");
  CpuDmaLatency(CpuDmaLatency&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  CpuDmaLatency& operator=(CpuDmaLatency&& other) noexcept {
    const CpuDmaLatency mine(std::exchange(fd_, std::exchange(other.fd_, -1)));  // ends here
    return *this;
  }
  ~CpuDmaLatency();

 private:
  explicit CpuDmaLatency(int fd) noexcept : fd_(fd) {}
  int fd_;
};

}  // namespace thimble::linux
