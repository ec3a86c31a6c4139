#pragma once

#include <memory>

#include "hal/device/haptic_device.hpp"

namespace thimble::devices {

// Ends devices, which may take the kernel seconds.
// Thread: control thread. Not RT. Ownership: takes what it is given.
class DeviceCloser {
 public:
  virtual ~DeviceCloser() = default;
  // nullptr: nothing.
  virtual void close(std::unique_ptr<HapticDevice> device) = 0;
};

}  // namespace thimble::devices
