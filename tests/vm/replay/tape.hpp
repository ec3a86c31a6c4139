#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/plugin/sim_model.hpp"
#include "hal/plugin/sim_usb_model.hpp"

namespace thimble::replay {

// The reports of a device, recorded. `info`: of the device that sent them.
struct Tape {
  bus::BusDeviceInfo info;
  std::vector<std::vector<std::uint8_t>> reports;  // of a Falcon: the replies of its firmware
};

// Plays a tape: a report for each report that it is sent, whatever is in that.
//
// Thread, RT, Errors: as SimHidModel. Ownership: the tape must outlive it. Beyond the tape's end:
// silence.
class TapeHid final : public plugin::SimHidModel {
 public:
  explicit TapeHid(const Tape& tape) : tape_(&tape) {}

  [[nodiscard]] bus::BusDeviceInfo describe() const override { return tape_->info; }
  [[nodiscard]] Duration frame_period() const noexcept override {
    return std::chrono::milliseconds(1);
  }
  void advance(MonotonicTime) noexcept override {}
  void out_report(std::span<const std::uint8_t>) noexcept override { ++asked_; }
  std::size_t in_report(std::span<std::uint8_t> out) noexcept override;
  void power_cycle() noexcept override { asked_ = played_ = 0; }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  const Tape* tape_;
  std::size_t asked_{0};
  std::size_t played_{0};
};

// The same for an arm behind a bridge chip: a packet out has a reply, in one packet behind the two
// bytes of the bridge's status; a request has a packet of the status alone. Else as TapeHid.
class TapeUsb final : public plugin::SimUsbModel {
 public:
  explicit TapeUsb(const Tape& tape) : tape_(&tape) {}

  [[nodiscard]] bus::BusDeviceInfo describe() const override { return tape_->info; }
  void advance(MonotonicTime) noexcept override {}
  plugin::UsbAnswer control(const bus::UsbControlRequest&,
                            std::span<std::uint8_t>) noexcept override;
  plugin::UsbHandshake out_packet(std::uint8_t, std::span<const std::uint8_t>) noexcept override;
  plugin::UsbAnswer in_packet(std::uint8_t, std::span<std::uint8_t> out) noexcept override;
  void power_cycle() noexcept override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  const Tape* tape_;
  std::deque<std::vector<std::uint8_t>> answers_;
  std::size_t played_{0};
};

}  // namespace thimble::replay
