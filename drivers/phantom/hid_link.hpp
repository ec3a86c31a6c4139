#pragma once

#include <atomic>
#include <memory>

#include "drivers/phantom/controller_link.hpp"
#include "hal/bus/hid_device.hpp"

namespace thimble::phantom {

// The controller's HID reports (phantom_wire.hpp): lock-step, every write is a report.
//
// Thread, RT, Errors: as ControllerLink. Ownership: owns its bus device, which closes with it.
class HidLink final : public ControllerLink {
 public:
  HidLink(std::unique_ptr<bus::HidDevice> bus, ReportForm form) noexcept;

  THIMBLE_RT_IO IoStatus read(ControllerReport& out) noexcept override;
  THIMBLE_RT_IO IoStatus write_currents(const std::array<double, 3>& current_a) noexcept override;
  THIMBLE_RT_IO IoStatus zero_counters() noexcept override;
  [[nodiscard]] bool is_zeroed_by_press() const noexcept override { return false; }
  [[nodiscard]] bool is_press_unseen() const noexcept override { return false; }
  [[nodiscard]] Duration watchdog() const noexcept override { return wire::kWatchdog; }
  [[nodiscard]] DeviceCounters counters() const noexcept override;
  [[nodiscard]] ZeroCommand zero_command() const noexcept override;
  [[nodiscard]] std::string_view trouble() const noexcept override { return {}; }

 private:
  std::unique_ptr<bus::HidDevice> bus_;
  ReportForm form_;
  bus::HidReport report_{};
  std::atomic<std::uint64_t> malformed_{0};
};

}  // namespace thimble::phantom
