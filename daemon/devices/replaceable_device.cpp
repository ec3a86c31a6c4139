#include "daemon/devices/replaceable_device.hpp"

#include <utility>

#include "daemon/devices/gone_device.hpp"
#include "hal/base/check.hpp"

namespace thimble::devices {

ReplaceableDevice::ReplaceableDevice(std::unique_ptr<HapticDevice> first, DeviceCloser& closer)
    : closer_(closer), current_(first.get()), known_(std::move(first)) {
  THIMBLE_CHECK(current_ != nullptr);
}

ReplaceableDevice::~ReplaceableDevice() {
  closer_.close(std::move(previous_));
  closer_.close(std::move(known_));
}

bool ReplaceableDevice::offer(std::unique_ptr<HapticDevice>& device) {
  THIMBLE_CHECK(device != nullptr);
  collect();
  if (previous_) return false;
  is_retired_ = false;
  previous_ = std::exchange(known_, std::move(device));
  incoming_.store(known_.get(), std::memory_order_release);
  return true;
}

bool ReplaceableDevice::retire() {
  if (is_retired_) return false;
  std::unique_ptr<HapticDevice> gone = std::make_unique<GoneDevice>(*known_);
  is_retired_ = offer(gone);
  return is_retired_;
}

void ReplaceableDevice::collect() {
  // The servo empties the mailbox when it takes the new device: it uses the old one no more.
  if (previous_ == nullptr || incoming_.load(std::memory_order_acquire) != nullptr) return;
  closed_ += previous_->counters();
  closer_.close(std::move(previous_));
}

const HapticCapabilities& ReplaceableDevice::capabilities() const noexcept {
  return known_->capabilities();
}

std::string_view ReplaceableDevice::calibration_instruction() const noexcept {
  return known_->calibration_instruction();
}

DeviceCounters ReplaceableDevice::counters() const noexcept {
  DeviceCounters all = closed_;
  if (previous_ != nullptr) all += previous_->counters();
  all += known_->counters();
  return all;
}

std::optional<ZeroCommand> ReplaceableDevice::zero_command() const noexcept {
  return known_->zero_command();
}

IoStatus ReplaceableDevice::read(HapticState& out) noexcept {
  HapticDevice* const fresh = incoming_.load(std::memory_order_acquire);
  if (fresh != nullptr) {
    current_ = fresh;
    incoming_.store(nullptr, std::memory_order_release);
  }
  return current_->read(out);
}

}  // namespace thimble::devices
