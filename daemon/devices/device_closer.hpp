#pragma once

#include <memory>

#include "hal/device/haptic_device.hpp"

namespace thimble::devices {

// Ends devices, which may take the kernel seconds: the destructor runs where the closer says
// (DeviceExecutor: in the arm's own thread, after what was posted before it), and nobody is told of
// its end. What uses a device as its destructor does (buses, clocks) must outlive that.
//
// Thread: control thread. Not RT. Ownership: takes what it is given. Errors: none.
class DeviceCloser {
 public:
  virtual ~DeviceCloser() = default;
  // Returns at once where destructors run elsewhere. nullptr: nothing.
  virtual void close(std::unique_ptr<HapticDevice> device) = 0;
};

}  // namespace thimble::devices
