#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "hal/bus/usb_device.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/plugin/plugin_abi.h"

namespace thimble::plugin {

// The claimed pipes of one device as a plugin sees them. Must not move: `table()` points at it.
// Thread, RT: as UsbDevice.
class PluginUsbBus {
 public:
  explicit PluginUsbBus(std::unique_ptr<bus::UsbDevice> below);
  PluginUsbBus(const PluginUsbBus&) = delete;
  PluginUsbBus& operator=(const PluginUsbBus&) = delete;

  [[nodiscard]] const thimble_usb_bus& table() const noexcept { return table_; }
  [[nodiscard]] bus::UsbDevice& below() const noexcept { return *below_; }
  // When the newest packet arrived that the plugin was given: no sample is younger.
  [[nodiscard]] MonotonicTime newest() const noexcept { return newest_; }
  THIMBLE_RT void note(MonotonicTime arrived_at) noexcept { newest_ = arrived_at; }

 private:
  std::unique_ptr<bus::UsbDevice> below_;
  MonotonicTime newest_{Duration::min()};
  thimble_usb_bus table_{};
};

// A USB arm that a plugin reads and writes. See make_plugin_usb_driver().
//
// Thread, RT: as HapticDevice; the plugin's functions run on the servo thread.
// Ownership: of the bus and of the plugin's own.
// Errors: as PluginDevice, and what the plugin says of its bus. Disconnected is believed where the
// bus says so, too, and of an arm that holds no force; of one that may hold one it is a
// ProtocolError until the arm has taken the zero, which is sent here. The destructor sends it, too.
class PluginUsbDevice final : public HapticDevice {
 public:
  struct Parts {
    const thimble_usb_driver* driver;
    void* device;  // of driver->open()
    std::unique_ptr<PluginUsbBus> bus;
    HapticCapabilities capabilities;
    std::optional<ZeroCommand> zero;
  };

  explicit PluginUsbDevice(Parts parts) : parts_(std::move(parts)) {}
  ~PluginUsbDevice() override;
  PluginUsbDevice(const PluginUsbDevice&) = delete;
  PluginUsbDevice& operator=(const PluginUsbDevice&) = delete;

  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override {
    return parts_.capabilities;
  }
  // Valid until the next call.
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override;
  [[nodiscard]] DeviceCounters counters() const noexcept override;
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override {
    return parts_.zero;
  }
  THIMBLE_RT void forget_calibration() noexcept override;
  THIMBLE_RT_IO IoStatus read(HapticState& out) noexcept override;
  THIMBLE_RT_IO IoStatus write(const LimitedWrench& wrench) noexcept override;

 private:
  IoStatus status_of(std::int32_t said) noexcept;
  [[nodiscard]] bool submit_zero() noexcept;
  // Whether a plugin that says so is believed.
  [[nodiscard]] bool is_gone() noexcept;
  // Of an arm, new, and no younger than what the plugin was given.
  [[nodiscard]] bool is_credible(const thimble_usb_sample& sample) const noexcept;

  Parts parts_;
  mutable thimble_reason instruction_{};  // of the control thread
  bool is_done_doubted_{false};           // as PluginDevice's
  std::uint64_t last_sequence_{0};
  bool may_hold_force_{false};    // it was told one
  std::uint32_t zeros_taken_{0};  // since then, of those sent here
  // Read from any thread.
  std::atomic<CalibrationState> calibration_{CalibrationState::Unknown};
  std::atomic<std::uint64_t> malformed_{0};
};

}  // namespace thimble::plugin
