#pragma once

#include "hal/plugin/sim_model.hpp"
#include "hal/plugin/sim_usb_model.hpp"
#include "sim/export/usb_descriptors.hpp"

namespace thimble::sim {

// A HID device as the bare USB device that it is on a wire: reports in packets of interrupt
// endpoints, requests of the HID class (HID 1.11, section 7.2) to endpoint 0.
//
// Thread, RT, Errors: as SimUsbModel. Ownership: the HID model must outlive it.
class HidOnUsb final : public plugin::SimUsbModel {
 public:
  static constexpr std::uint8_t kIn = 0x81;
  static constexpr std::uint8_t kOut = 0x01;

  explicit HidOnUsb(plugin::SimHidModel& model) : model_(&model) {}

  // With the endpoints; the one that goes out only where the device has output reports.
  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  // As a host is shown it: `info`'s ids and names, with what makes it a HID device. Not RT.
  [[nodiscard]] UsbPersona persona(const bus::BusDeviceInfo& info) const;
  void advance(MonotonicTime t) noexcept override { model_->advance(t); }
  plugin::UsbAnswer control(const bus::UsbControlRequest& request,
                            std::span<std::uint8_t> in) noexcept override;
  plugin::UsbHandshake out_packet(std::uint8_t endpoint,
                                  std::span<const std::uint8_t> bytes) noexcept override;
  plugin::UsbAnswer in_packet(std::uint8_t endpoint, std::span<std::uint8_t> out) noexcept override;
  void power_cycle() noexcept override { model_->power_cycle(); }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override {
    return model_->arm_backend();
  }

 private:
  plugin::SimHidModel* model_;
};

}  // namespace thimble::sim
