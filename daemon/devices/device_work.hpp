#pragma once

#include <functional>
#include <memory>

#include "daemon/devices/device_closer.hpp"

namespace thimble::devices {

// Where is done what the kernel may hold up for seconds: looking for a device, opening it, closing
// it.
//
// Thread: post() from the control thread. Not RT.
// Ownership: a task owns what it uses, or that outlives the work. Errors: a task throws nothing.
class DeviceWork : public DeviceCloser {
 public:
  using Task = std::function<void()>;
  // One after the other, as they were posted.
  virtual void post(Task task) = 0;
  void close(std::unique_ptr<HapticDevice> device) final;
};

// At once, in the caller's thread: for devices that hold nobody up, as simulated ones.
class WorkAtOnce final : public DeviceWork {
 public:
  void post(Task task) override { task(); }
};

}  // namespace thimble::devices
