#include "daemon/devices/device_executor.hpp"

#include <utility>

namespace thimble::devices {

void DeviceExecutor::close(std::unique_ptr<HapticDevice> device) {
  if (device == nullptr) return;
  post([held = std::make_shared<std::unique_ptr<HapticDevice>>(std::move(device))] {
    held->reset();
  });
}

}  // namespace thimble::devices
