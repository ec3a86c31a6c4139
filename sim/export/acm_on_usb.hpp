#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hal/plugin/sim_serial_model.hpp"
#include "hal/plugin/sim_usb_model.hpp"
#include "sim/export/usb_descriptors.hpp"

namespace thimble::sim {

// A simulated device on a serial port as the USB device that it is on a wire: CDC-ACM, a modem of
// which only its stream of bytes is used (USB CDC 1.2, and its PSTN subclass 1.2). A kernel's
// driver for that class (Linux: cdc_acm) makes a terminal of it.
//
// Bytes go in packets of two bulk pipes, as many as a full-speed bus has room for. Of a packet for
// which the device has no room the rest waits here, and the next one is refused (NAK) meanwhile.
// What fills its last packet is ended by an empty one, or the host would wait for more. The line's
// settings are kept and told again, and change nothing; nothing is ever said on the interrupt pipe.
//
// Precondition: bit_per_s() of the model is 0. Thread, RT, Errors: as SimUsbModel. Ownership: the
// serial model must outlive it.
class AcmOnUsb final : public plugin::SimUsbModel {
 public:
  static constexpr std::uint8_t kNotifications = 0x81;
  static constexpr std::uint8_t kOut = 0x02;
  static constexpr std::uint8_t kIn = 0x82;
  static constexpr std::size_t kPacketBytes = 64;
  // PSTN 1.2, 6.3.10: rate in bit/s (32 bits, the lowest first), stop bits, parity, data bits.
  using LineCoding = std::array<std::uint8_t, 7>;
  static constexpr LineCoding kLineAtPowerUp{0x00, 0xC2, 0x01, 0x00, 0, 0, 8};  // ours: 115200, 8N1

  explicit AcmOnUsb(plugin::SimSerialModel& model) : model_(&model) {}

  // With the endpoints of both.
  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  // As a host is shown it: `info`'s ids and names, with what makes it such a modem. Not RT.
  [[nodiscard]] UsbPersona persona(const bus::BusDeviceInfo& info) const;
  void advance(MonotonicTime t) noexcept override;
  plugin::UsbAnswer control(const bus::UsbControlRequest& request,
                            std::span<std::uint8_t> in) noexcept override;
  plugin::UsbHandshake out_packet(std::uint8_t endpoint,
                                  std::span<const std::uint8_t> bytes) noexcept override;
  plugin::UsbAnswer in_packet(std::uint8_t endpoint, std::span<std::uint8_t> out) noexcept override;
  [[nodiscard]] MonotonicTime unchanged_until() const noexcept override;
  void power_cycle() noexcept override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override {
    return model_->arm_backend();
  }
  // PSTN 1.2, 6.3.12: bit 0 is DTR, somebody has the port open; bit 1 is RTS.
  [[nodiscard]] std::uint16_t control_lines() const noexcept { return control_lines_; }

 private:
  // False while some of it still waits.
  bool hand_over() noexcept;

  plugin::SimSerialModel* model_;
  LineCoding line_{kLineAtPowerUp};
  std::uint16_t control_lines_{0};
  std::array<std::uint8_t, kPacketBytes> packet_{};  // from the host
  std::size_t packet_begin_{0};                      // what the model did not take yet
  std::size_t packet_end_{0};
  bool is_end_owed_{false};  // of what went to the host: its last packet was full
};

}  // namespace thimble::sim
