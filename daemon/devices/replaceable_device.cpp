#include "daemon/devices/replaceable_device.hpp"

#include <string>
#include <utility>

#include "hal/base/check.hpp"

namespace thimble::devices {
namespace {

// The place of a device that is gone: it remembers what the device was, and never answers.
class GoneDevice final : public HapticDevice {
 public:
  explicit GoneDevice(const HapticDevice& gone)
      : capabilities_(gone.capabilities()),
        instruction_(gone.calibration_instruction()),
        counters_(gone.counters()) {}

  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override {
    return instruction_;
  }
  [[nodiscard]] DeviceCounters counters() const noexcept override { return counters_; }
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override { return {}; }
  void forget_calibration() noexcept override {}
  IoStatus read(HapticState& /*out*/) noexcept override { return IoStatus::Disconnected; }
  IoStatus write(const LimitedWrench& /*wrench*/) noexcept override {
    return IoStatus::Disconnected;
  }

 private:
  HapticCapabilities capabilities_;
  std::string instruction_;
  DeviceCounters counters_;
};

}  // namespace

ReplaceableDevice::ReplaceableDevice(std::unique_ptr<HapticDevice> first)
    : current_(first.get()), known_(std::move(first)) {
  THIMBLE_CHECK(current_ != nullptr);
}

ReplaceableDevice::~ReplaceableDevice() = default;

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
  if (incoming_.load(std::memory_order_acquire) == nullptr) previous_.reset();
}

const HapticCapabilities& ReplaceableDevice::capabilities() const noexcept {
  return known_->capabilities();
}

std::string_view ReplaceableDevice::calibration_instruction() const noexcept {
  return known_->calibration_instruction();
}

DeviceCounters ReplaceableDevice::counters() const noexcept { return known_->counters(); }

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
