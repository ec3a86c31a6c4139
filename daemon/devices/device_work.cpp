#include "daemon/devices/device_work.hpp"

#include <utility>

namespace thimble::devices {

void DeviceWork::close(std::unique_ptr<HapticDevice> device) {
  if (device == nullptr) return;
  post([held = std::make_shared<std::unique_ptr<HapticDevice>>(std::move(device))] {
    held->reset();
  });
}

}  // namespace thimble::devices
