#include "daemon/app/device_threads.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "daemon/session/world_settings.hpp"
#include "hal/bus/device_address.hpp"
#include "hal/linux/background_worker.hpp"

namespace thimble::app {

namespace {

std::string name_of_arm(const std::string& arm) { return "arm '" + arm + "'"; }
std::string name_of_board(const std::string& world) { return "the board of world '" + world + "'"; }

}  // namespace

bool has_real_device(const config::Config& config) {
  return std::any_of(config.arms.begin(), config.arms.end(),
                     [](const config::ArmConfig& arm) { return !bus::is_simulated(arm.device); }) ||
         std::any_of(config.worlds.begin(), config.worlds.end(), session::is_board_plugged_in);
}

class DeviceThreads::OfOneDevice final : public devices::DeviceExecutor {
 public:
  OfOneDevice() = default;
  // A device that is being closed uses what the daemon owns.
  ~OfOneDevice() override { worker_.finish(); }
  OfOneDevice(const OfOneDevice&) = delete;
  OfOneDevice& operator=(const OfOneDevice&) = delete;
  void post(Task task) override { worker_.post(std::move(task)); }
  [[nodiscard]] bool wait(Duration patience) { return worker_.wait(patience); }

 private:
  linux::BackgroundWorker worker_;
};

DeviceThreads::DeviceThreads() = default;
DeviceThreads::~DeviceThreads() = default;

devices::DeviceExecutor& DeviceThreads::executor_for(const std::string& arm) {
  return *threads_.at(name_of_arm(arm));
}

devices::DeviceExecutor& DeviceThreads::executor_for_board(const std::string& world) {
  return *threads_.at(name_of_board(world));
}

std::vector<std::string> DeviceThreads::late_after(Duration patience, const Clock& clock) {
  const MonotonicTime deadline = clock.now() + patience;
  std::vector<std::string> late;
  for (const auto& [name, thread] : threads_) {
    if (!thread->wait(std::max(Duration(0), deadline - clock.now()))) late.push_back(name);
  }
  return late;
}

Result<std::unique_ptr<DeviceThreads>> DeviceThreads::start(const config::Config& config) {
  std::unique_ptr<DeviceThreads> threads(new DeviceThreads());
  const auto add = [&](const std::string& name) {
    threads->threads_.emplace(name, std::make_unique<OfOneDevice>());
  };
  try {
    for (const config::ArmConfig& arm : config.arms) {
      if (!bus::is_simulated(arm.device)) add(name_of_arm(arm.name));
    }
    for (const config::WorldConfig& world : config.worlds) {
      if (session::is_board_plugged_in(world)) add(name_of_board(world.name));
    }
  } catch (const std::system_error& error) {
    return fail(Errc::System, std::string("no thread to open a device in: ") + error.what());
  }
  return threads;
}

}  // namespace thimble::app
