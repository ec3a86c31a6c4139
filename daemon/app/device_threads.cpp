#include "daemon/app/device_threads.hpp"

#include <system_error>
#include <utility>

#include "hal/bus/device_address.hpp"
#include "hal/linux/background_worker.hpp"

namespace thimble::app {
namespace {

class DeviceThread final : public devices::DeviceWork {
 public:
  DeviceThread() = default;
  // A device that is being closed uses what the daemon owns.
  ~DeviceThread() override { worker_.finish(); }
  DeviceThread(const DeviceThread&) = delete;
  DeviceThread& operator=(const DeviceThread&) = delete;
  void post(Task task) override { worker_.post(std::move(task)); }

 private:
  linux::BackgroundWorker worker_;
};

}  // namespace

DeviceThreads::~DeviceThreads() = default;

Result<std::unique_ptr<DeviceThreads>> DeviceThreads::start(const config::Config& config) {
  std::unique_ptr<DeviceThreads> threads(new DeviceThreads());
  try {
    for (const config::ArmConfig& arm : config.arms) {
      if (bus::is_simulated(arm.device)) continue;
      threads->threads_.emplace(arm.name, std::make_unique<DeviceThread>());
    }
  } catch (const std::system_error& error) {
    return fail(Errc::System, std::string("no thread to open an arm in: ") + error.what());
  }
  return threads;
}

}  // namespace thimble::app
