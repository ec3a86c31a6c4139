#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/spacemouse/pointer.hpp"
#include "drivers/spacemouse/spacemouse_model.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/hid_device.hpp"
#include "hal/device/haptic_device.hpp"

namespace thimble::spacemouse {

// A 3Dconnexion puck as an arm without motors: its tip is the point that it drives (Pointer).
//
// A puck at rest is silent, so every read is a sample, taken at that time: the age of its last
// report says nothing. That it is still there the bus says. Buttons as the puck numbers them, from
// bit 0. Nothing is ever sent; a wrench is taken and goes nowhere.
//
// Of two reports that came between two reads only the newest is had (HidDevice): with separate
// layouts one of two deflections may then be 16 ms old.
//
// Thread, RT: as HapticDevice; no allocation after the constructor.
// Errors: read() never gives NoData; ProtocolError (counted as malformed) for a report that no puck
// sends, and the point moves on meanwhile; Disconnected when the bus is lost. write() gives
// Disconnected once read() did, else Ok.
// Ownership: `model` and `clock` must outlive it. The clock is the one that stamps the bus.
class SpaceMouseDevice final : public HapticDevice {
 public:
  SpaceMouseDevice(std::unique_ptr<bus::HidDevice> bus, const SpaceMouseModel& model,
                   const Clock& clock);

  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override;
  [[nodiscard]] DeviceCounters counters() const noexcept override;
  // It cannot push, so nobody need stop it.
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override {
    return std::nullopt;
  }
  THIMBLE_RT void forget_calibration() noexcept override;
  THIMBLE_RT_IO IoStatus read(HapticState& out) noexcept override;
  THIMBLE_RT_IO IoStatus write(const LimitedWrench& wrench) noexcept override;

 private:
  [[nodiscard]] bool take(const bus::HidReport& report) noexcept;
  void publish_calibration() noexcept;

  std::unique_ptr<bus::HidDevice> bus_;
  const Clock& clock_;
  HapticCapabilities capabilities_;
  bus::HidReport report_{};
  Pointer pointer_;
  std::uint32_t buttons_{0};
  std::uint64_t samples_{0};
  bool is_connected_{true};
  // Read from any thread.
  std::atomic<CalibrationState> calibration_{CalibrationState::Unknown};
  std::atomic<std::uint64_t> malformed_{0};
};

}  // namespace thimble::spacemouse
