#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/plugin/sim_model.hpp"
#include "hal/plugin/sim_serial_model.hpp"
#include "hal/plugin/sim_usb_model.hpp"

namespace thimble::speed {

// What an exchange carries, each way: as much as an arm of the PHANToM family sends.
inline constexpr std::size_t kExchangeBytes = 16;
inline constexpr const char* kSerial = "VM-ECHO-1";
// Of a Falcon, which no driver of the kernel wants: a bulk pipe each way.
inline constexpr std::uint8_t kBulkIn = 0x81;
inline constexpr std::uint8_t kBulkOut = 0x02;

// The newest of what came, until it is fetched.
class Echo {
 public:
  void take(std::span<const std::uint8_t> bytes) noexcept;
  // Bytes that were written to `out`; 0: nothing came.
  std::size_t give(std::span<std::uint8_t> out) noexcept;

 private:
  std::array<std::uint8_t, kExchangeBytes> bytes_{};
  std::size_t size_{0};
};

// Devices that send back what they are sent. Thread, RT, Errors: as SimHidModel, SimUsbModel and
// SimSerialModel.
class EchoHid final : public plugin::SimHidModel {
 public:
  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  [[nodiscard]] Duration frame_period() const noexcept override {
    return std::chrono::milliseconds(1);
  }
  void advance(MonotonicTime) noexcept override {}
  void out_report(std::span<const std::uint8_t> bytes) noexcept override { echo_.take(bytes); }
  std::size_t in_report(std::span<std::uint8_t> out) noexcept override { return echo_.give(out); }
  void power_cycle() noexcept override { echo_ = {}; }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  Echo echo_;
};

class EchoUsb final : public plugin::SimUsbModel {
 public:
  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  void advance(MonotonicTime) noexcept override {}
  plugin::UsbAnswer control(const bus::UsbControlRequest&,
                            std::span<std::uint8_t>) noexcept override {
    return {plugin::UsbHandshake::Stall, 0};
  }
  plugin::UsbHandshake out_packet(std::uint8_t, std::span<const std::uint8_t>) noexcept override;
  plugin::UsbAnswer in_packet(std::uint8_t, std::span<std::uint8_t> out) noexcept override;
  void power_cycle() noexcept override { echo_ = {}; }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  Echo echo_;
};

class EchoSerial final : public plugin::SimSerialModel {
 public:
  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  [[nodiscard]] std::uint32_t bit_per_s() const noexcept override { return 0; }
  void advance(MonotonicTime) noexcept override {}
  std::size_t take(std::span<const std::uint8_t> bytes) noexcept override {
    echo_.take(bytes);
    return bytes.size();
  }
  std::size_t give(std::span<std::uint8_t> out) noexcept override { return echo_.give(out); }
  void power_cycle() noexcept override { echo_ = {}; }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  Echo echo_;
};

}  // namespace thimble::speed
