#include "hal/linux/cpu_dma_latency.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

namespace thimble::linux {
namespace {

Error refusal(const char* node, int error) {
  const std::string what = std::string(node) + " refused (" + std::strerror(error) + "): ";
  if (error == ENOENT) {
    return {Errc::NotFound, what +
                                "the kernel or the sandbox does not offer it; "
                                "add DeviceAllow=/dev/cpu_dma_latency rw to the unit"};
  }
  const bool is_permission = error == EACCES || error == EPERM;
  return {is_permission ? Errc::Permission : Errc::System,
          what +
              "needs write access to the node; give it to the daemon's group with a udev rule "
              "(KERNEL==\"cpu_dma_latency\", GROUP=\"thimble\", MODE=\"0660\") and "
              "DeviceAllow=/dev/cpu_dma_latency rw in the unit"};
}

}  // namespace

Result<CpuDmaLatency> CpuDmaLatency::hold(const char* node) {
  const int fd = ::open(node, O_WRONLY | O_CLOEXEC);
  if (fd < 0) return tl::unexpected<Error>(refusal(node, errno));
  CpuDmaLatency held(fd);
  const std::int32_t latency_us = 0;  // the kernel takes a binary s32
  if (::write(fd, &latency_us, sizeof(latency_us)) != static_cast<ssize_t>(sizeof(latency_us))) {
    return tl::unexpected<Error>(refusal(node, errno));
  }
  return held;
}

CpuDmaLatency::~CpuDmaLatency() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace thimble::linux
