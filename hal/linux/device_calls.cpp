#include "hal/linux/device_calls.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

namespace thimble::linux {

std::ptrdiff_t KernelCalls::write(int node, std::span<const std::uint8_t> bytes) noexcept {
  return ::write(node, bytes.data(), bytes.size());
}

int KernelCalls::control(int node, unsigned long request, void* argument) noexcept {
  return ::ioctl(node, request, argument);
}

}  // namespace thimble::linux
