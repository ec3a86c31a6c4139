#include "daemon/app/device_threads.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "hal/bus/device_address.hpp"
#include "hal/linux/background_worker.hpp"

namespace thimble::app {

class DeviceThreads::OfOneArm final : public devices::DeviceExecutor {
 public:
  OfOneArm() = default;
  // A device that is being closed uses what the daemon owns.
  ~OfOneArm() override { worker_.finish(); }
  OfOneArm(const OfOneArm&) = delete;
  OfOneArm& operator=(const OfOneArm&) = delete;
  void post(Task task) override { worker_.post(std::move(task)); }
  [[nodiscard]] bool wait(Duration patience) { return worker_.wait(patience); }

 private:
  linux::BackgroundWorker worker_;
};

DeviceThreads::DeviceThreads() = default;
DeviceThreads::~DeviceThreads() = default;

devices::DeviceExecutor& DeviceThreads::executor_for(const std::string& arm) {
  return *threads_.at(arm);
}

std::vector<std::string> DeviceThreads::late_after(Duration patience, const Clock& clock) {
  const MonotonicTime deadline = clock.now() + patience;
  std::vector<std::string> late;
  for (const auto& [arm, thread] : threads_) {
    if (!thread->wait(std::max(Duration(0), deadline - clock.now()))) late.push_back(arm);
  }
  return late;
}

Result<std::unique_ptr<DeviceThreads>> DeviceThreads::start(const config::Config& config) {
  std::unique_ptr<DeviceThreads> threads(new DeviceThreads());
  try {
    for (const config::ArmConfig& arm : config.arms) {
      if (bus::is_simulated(arm.device)) continue;
      threads->threads_.emplace(arm.name, std::make_unique<OfOneArm>());
    }
  } catch (const std::system_error& error) {
    return fail(Errc::System, std::string("no thread to open an arm in: ") + error.what());
  }
  return threads;
}

}  // namespace thimble::app
