#pragma once

#include <functional>
#include <memory>

#include "daemon/devices/device_closer.hpp"

namespace thimble::devices {

// Where is done what the kernel may hold up for seconds: looking for a device, opening it, closing
// it. Nobody is told that a task is done: who wants to know looks at what the task shares with him.
//
// Thread: post() and close() from the control thread. Not RT.
// Ownership: a task owns what it uses, or that outlives the work. Errors: a task throws nothing.
class DeviceExecutor : public DeviceCloser {
 public:
  using Task = std::function<void()>;
  // One after the other, as they were posted, closings among them. Returns at once, but of work
  // that is done in the caller's thread.
  virtual void post(Task task) = 0;
  // As post(): the device's destructor runs where tasks do, after all that was posted before.
  void close(std::unique_ptr<HapticDevice> device) final;
};

// At once, in the caller's thread: for devices that hold nobody up, as simulated ones.
class InlineExecutor final : public DeviceExecutor {
 public:
  void post(Task task) override { task(); }
};

}  // namespace thimble::devices
