#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace thimble::linux {

// The kernel's calls by which a device is told something, where a test must be able to answer for
// the kernel: what it says of a device that hangs, or of a line that is full, no test can bring
// about.
//
// Thread: any. RT: as the kernel's call. Errors: as there, -1 and errno.
class DeviceCalls {
 public:
  virtual ~DeviceCalls() = default;
  virtual std::ptrdiff_t write(int node, std::span<const std::uint8_t> bytes) noexcept = 0;
  // ioctl().
  virtual int control(int node, unsigned long request, void* argument) noexcept = 0;
  // Whether this descriptor will never reach its device again: the device left, also when it comes
  // back, which is by another node. poll() says so of usbfs, hidraw and terminals, and of a hiddev
  // without unread events. False where poll() fails. Does not wait.
  virtual bool is_gone(int node) noexcept = 0;
};

class KernelCalls final : public DeviceCalls {
 public:
  std::ptrdiff_t write(int node, std::span<const std::uint8_t> bytes) noexcept override;
  int control(int node, unsigned long request, void* argument) noexcept override;
  bool is_gone(int node) noexcept override;
};

}  // namespace thimble::linux
