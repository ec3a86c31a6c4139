#pragma once

#include <map>
#include <memory>
#include <string>

#include "daemon/config/config.hpp"
#include "daemon/devices/device_work.hpp"
#include "hal/base/result.hpp"

namespace thimble::app {

// A thread for each real arm of the configuration, in which it is looked for, opened and closed: no
// arm waits for another one's kernel, and the control plane for none.
//
// Thread: control plane. Not RT; the threads have no priority. Ownership: must outlive what posts
// to it; what its tasks use must outlive it. Its end waits until all that was posted is done.
class DeviceThreads {
 public:
  // Errors: System, where no more threads can be had.
  [[nodiscard]] static Result<std::unique_ptr<DeviceThreads>> start(const config::Config& config);
  ~DeviceThreads();
  DeviceThreads(const DeviceThreads&) = delete;
  DeviceThreads& operator=(const DeviceThreads&) = delete;

  // `arm`: the name of a real one of the configuration.
  [[nodiscard]] devices::DeviceWork& of(const std::string& arm) { return *threads_.at(arm); }

 private:
  DeviceThreads() = default;
  std::map<std::string, std::unique_ptr<devices::DeviceWork>> threads_;
};

}  // namespace thimble::app
