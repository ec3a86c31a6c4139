#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "hal/bus/hid_device.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/plugin/plugin_abi.h"

namespace thimble::plugin {

// An arm whose bytes a plugin makes and reads; the bus is ours. See make_plugin_driver().
//
// Thread, RT: as HapticDevice; the plugin's functions run on the servo thread.
// Ownership: of the bus device and of the plugin's own.
// Errors: ProtocolError, counted as malformed, for whatever the plugin refuses or gets wrong; the
// reference is forgotten with a sample that no arm can have. Once it was forgotten, a sample that
// says DONE counts as NeedsUser until one came that did not say it.
class PluginDevice final : public HapticDevice {
 public:
  struct Parts {
    const thimble_driver* driver;
    void* device;  // of driver->open()
    std::unique_ptr<bus::HidDevice> bus;
    std::size_t output_report_bytes;
  };

  PluginDevice(Parts parts, HapticCapabilities capabilities, std::string instruction);
  ~PluginDevice() override;
  PluginDevice(const PluginDevice&) = delete;
  PluginDevice& operator=(const PluginDevice&) = delete;

  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override;
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override;
  [[nodiscard]] DeviceCounters counters() const noexcept override;
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override;
  THIMBLE_RT void forget_calibration() noexcept override;
  THIMBLE_RT_IO IoStatus read(HapticState& out) noexcept override;
  THIMBLE_RT_IO IoStatus write(const LimitedWrench& wrench) noexcept override;

 private:
  [[nodiscard]] std::optional<ZeroCommand> ask_for_zero() noexcept;
  IoStatus count_malformed() noexcept;

  Parts parts_;
  HapticCapabilities capabilities_;
  std::string instruction_;
  std::optional<ZeroCommand> zero_;
  bus::HidReport report_{};
  bool is_done_doubted_{false};  // the reference was forgotten, and the plugin has not said so yet
  // Read from any thread.
  std::atomic<CalibrationState> calibration_{CalibrationState::Unknown};
  std::atomic<std::uint64_t> malformed_{0};
};

}  // namespace thimble::plugin
