#pragma once

#include <atomic>
#include <memory>

#include "daemon/devices/device_closer.hpp"
#include "hal/device/haptic_device.hpp"

namespace thimble::devices {

// The arm as the servo holds it for the whole life of a session, while the device behind it
// may be unplugged and come back: the control thread offers the newly opened device, the servo
// takes it at its next read, the control thread collects the old one.
//
// Thread: read(), write(), forget_calibration() from the servo; offer(), collect() from one
//         control thread; capabilities(), has_reported(), counters(), zero_command() and the
//         instruction from that control thread too. A device ends where its closer closes it, of a
//         real arm in the arm's own thread: neither the servo nor the control thread has it then.
// RT: read() and write() are THIMBLE_RT_IO; the hand-over is one atomic exchange.
// Ownership: owns every device given to it, and closes them by `closer`, which must outlive it.
class ReplaceableDevice final : public HapticDevice {
 public:
  ReplaceableDevice(std::unique_ptr<HapticDevice> first, DeviceCloser& closer);
  ~ReplaceableDevice() override;
  ReplaceableDevice(const ReplaceableDevice&) = delete;
  ReplaceableDevice& operator=(const ReplaceableDevice&) = delete;

  // Puts `device` in place of the present one. False (and `device` is kept by the caller)
  // while an earlier offer still waits for the servo.
  bool offer(std::unique_ptr<HapticDevice>& device);
  // Puts nothing in place of a device that is of no use any more, so that its handle is closed:
  // a bus may refuse a second one while the first, dead as it is, is open. What was known of
  // the device stays. True when this call did it.
  bool retire();
  // Since then nothing was offered: the device is closed already, or at any moment.
  [[nodiscard]] bool is_retired() const noexcept { return is_retired_; }
  // Closes the device that the servo has let go of, if any.
  void collect();

  // These four are of the newest device that was offered, while the servo may still drive the one
  // before.
  [[nodiscard]] bool has_reported() const noexcept { return known_->counters().reports_in > 0; }
  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override;
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override;
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override;
  // Of every device that was here: they never fall.
  [[nodiscard]] DeviceCounters counters() const noexcept override;
  THIMBLE_RT void forget_calibration() noexcept override { current_->forget_calibration(); }
  THIMBLE_RT_IO IoStatus read(HapticState& out) noexcept override;
  THIMBLE_RT_IO IoStatus write(const LimitedWrench& wrench) noexcept override {
    return current_->write(wrench);
  }

 private:
  DeviceCloser& closer_;
  HapticDevice* current_;                         // servo
  std::unique_ptr<HapticDevice> known_;           // control: the newest offered
  std::unique_ptr<HapticDevice> previous_;        // control: until the servo lets go of it
  DeviceCounters closed_;                         // control: of those before it
  std::atomic<HapticDevice*> incoming_{nullptr};  // control → servo
  bool is_retired_{false};                        // control
};

}  // namespace thimble::devices
