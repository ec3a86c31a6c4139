#include "hal/linux/device_calls.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace thimble::linux {

std::ptrdiff_t KernelCalls::write(int node, std::span<const std::uint8_t> bytes) noexcept {
  return ::write(node, bytes.data(), bytes.size());
}

int KernelCalls::control(int node, unsigned long request, void* argument) noexcept {
  return ::ioctl(node, request, argument);
}

// POLLHUP of Linux 6.1: usbdev_poll(), hidraw_poll(), hiddev_poll(), hung_up_tty_poll().
bool KernelCalls::is_gone(int node) noexcept {
  pollfd device{node, 0, 0};
  return ::poll(&device, 1, 0) > 0 && (device.revents & POLLHUP) != 0;
}

}  // namespace thimble::linux
