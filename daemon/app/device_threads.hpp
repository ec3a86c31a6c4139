#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/devices/device_executor.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::app {

// Whether it names an arm or a board that is not simulated.
[[nodiscard]] bool has_real_device(const config::Config& config);

// A thread for each real arm of the configuration, and for each world whose board is plugged in, in
// which it is looked for, opened and closed: no arm waits for another one's kernel, and the control
// thread for none.
//
// Thread: control thread. Not RT; the threads have no priority. Ownership: must outlive what posts
// to it; what its tasks use must outlive it. Its end waits until all that was posted is done,
// however long: who may not wait asks late_after() before.
class DeviceThreads {
 public:
  // Errors: System, where no more threads can be had.
  [[nodiscard]] static Result<std::unique_ptr<DeviceThreads>> start(const config::Config& config);
  ~DeviceThreads();
  DeviceThreads(const DeviceThreads&) = delete;
  DeviceThreads& operator=(const DeviceThreads&) = delete;

  // `arm`: the name of a real one of the configuration; another is the caller's mistake, and throws
  // std::out_of_range. So here and below.
  [[nodiscard]] devices::DeviceExecutor& executor_for(const std::string& arm);
  // `world`: the name of one whose board is plugged in.
  [[nodiscard]] devices::DeviceExecutor& executor_for_board(const std::string& world);
  // For a person, those of which not all that was posted is done after `patience`, which is for all
  // of them together: "arm 'left'", "the board of world 'desk'".
  [[nodiscard]] std::vector<std::string> late_after(Duration patience, const Clock& clock);

 private:
  class OfOneDevice;
  DeviceThreads();
  std::map<std::string, std::unique_ptr<OfOneDevice>> threads_;  // by what late_after() calls it
};

}  // namespace thimble::app
