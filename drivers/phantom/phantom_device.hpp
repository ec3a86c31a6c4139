#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/phantom/controller_link.hpp"
#include "drivers/phantom/counter_tracker.hpp"
#include "drivers/phantom/homing.hpp"
#include "drivers/phantom/phantom_kinematics.hpp"
#include "hal/device/haptic_device.hpp"

namespace thimble::phantom {

// A PHANToM or WoodenHaptics arm behind the open controller.
//
// Until calibrated the state carries the home pose: the counters have no reference yet, and a
// made-up place had better be a known one. Every write that the link takes sends a command, so that
// the controller's exchange and watchdog live; before calibration it holds no current. A text link
// takes none while an answer is owed.
//
// The reference is forgotten, and the person must press the button again, when the counters
// jump (CounterTracker says what a jump is: counted as malformed, ProtocolError), when no
// report came for the watchdog time of a controller that may have been reset meanwhile, when the
// bus is lost, by forget_calibration(), and when the controller zeroes its counters at a press by
// itself.
//
// Thread, RT, Ownership: as HapticDevice; no allocation after the constructor.
class PhantomDevice final : public HapticDevice {
 public:
  // `model` must outlive the device; those of the table do. `amplifier_max_a`: full scale of the
  // firmware build, above 0 and at most 32.767 (wire::kLargestCurrentA). match() refuses others;
  // here it is not checked again, and one below 0 would turn forces round.
  PhantomDevice(std::unique_ptr<ControllerLink> link, const PhantomModel& model,
                double amplifier_max_a);
  ~PhantomDevice() override;
  PhantomDevice(const PhantomDevice&) = delete;
  PhantomDevice& operator=(const PhantomDevice&) = delete;

  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override;
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override;
  [[nodiscard]] DeviceCounters counters() const noexcept override;
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override;
  THIMBLE_RT void forget_calibration() noexcept override;
  THIMBLE_RT_IO IoStatus read(HapticState& out) noexcept override;
  THIMBLE_RT_IO IoStatus write(const LimitedWrench& wrench) noexcept override;

 private:
  // Where the newest report stands on the bus's time line.
  struct Arrival {
    MonotonicTime at{};
    std::uint64_t sequence{0};
  };

  IoStatus take(const DeviceReport& report, const Arrival& arrival) noexcept;
  Duration since_last(const Arrival& arrival) const noexcept;
  void publish_calibration() noexcept;
  IoStatus count_malformed() noexcept;
  [[nodiscard]] std::array<double, kMaxJoints> joint_angle_rad(
      const DeviceReport& report) const noexcept;
  [[nodiscard]] std::array<double, 3> currents_for(Force3 force) const noexcept;

  std::unique_ptr<ControllerLink> link_;
  const PhantomModel& model_;
  HapticCapabilities capabilities_;
  std::string home_instruction_;
  std::string unseen_instruction_;
  ControllerReport report_{};
  Homing homing_{};
  CounterTracker tracker_;
  ArmPose pose_;
  Arrival last_{};
  bool has_last_{false};
  // Read from any thread.
  std::atomic<CalibrationState> calibration_{CalibrationState::Unknown};
  std::atomic<std::uint64_t> malformed_{0};
};

}  // namespace thimble::phantom
