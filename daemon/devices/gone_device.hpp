#pragma once

#include <string>
#include <utility>

#include "hal/device/haptic_device.hpp"

namespace thimble::devices {

// The place of a device that is gone, or was never there: it tells what is known of it, never
// answers, and has counted nothing.
//
// Thread, RT: as HapticDevice.
class GoneDevice final : public HapticDevice {
 public:
  explicit GoneDevice(HapticCapabilities known) : capabilities_(std::move(known)) {}
  explicit GoneDevice(const HapticDevice& gone)
      : capabilities_(gone.capabilities()), instruction_(gone.calibration_instruction()) {}

  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override {
    return instruction_;
  }
  [[nodiscard]] DeviceCounters counters() const noexcept override { return {}; }
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override { return {}; }
  THIMBLE_RT void forget_calibration() noexcept override {}
  THIMBLE_RT_IO IoStatus read(HapticState& /*out*/) noexcept override {
    return IoStatus::Disconnected;
  }
  THIMBLE_RT_IO IoStatus write(const LimitedWrench& /*wrench*/) noexcept override {
    return IoStatus::Disconnected;
  }

 private:
  HapticCapabilities capabilities_;
  std::string instruction_;
};

}  // namespace thimble::devices
