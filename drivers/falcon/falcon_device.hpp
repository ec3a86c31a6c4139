#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/falcon/arm_reference.hpp"
#include "drivers/falcon/boot_sequence.hpp"
#include "drivers/falcon/exchange_pacer.hpp"
#include "drivers/falcon/falcon_codec.hpp"
#include "drivers/falcon/falcon_kinematics.hpp"
#include "hal/bus/usb_device.hpp"
#include "hal/device/haptic_device.hpp"

namespace thimble::falcon {

// A Novint Falcon.
//
// write() sends everything: while the arm boots the next step of that, and no force; then a request
// whenever the last one is answered, with zero until the arm is homed. A request that takes the
// force away does not wait for the answer to the last. read() takes what came; before the firmware
// runs that is NoData, so that the arm stays Configured. Nobody answers for half a second: zeros,
// and then from the boot on again. A request to the bridge that never ends: Disconnected, for good.
// Time is that of the packets, of which the bridge sends one each latency period; where none comes
// for kSilentPipe it is the clock's.
//
// Buttons: bit 0 the one in the middle, 1 left, 2 forward, 3 right. Lights: red until homed, green
// after, blue while there is force.
//
// Until homed the state carries the middle of the workspace: a made-up place had better be a known
// one. The reference is forgotten as ArmReference says, when a crank is beyond its stops, when no
// pose fits the encoders, and when the bus is lost.
//
// What an ampere of this arm is nobody knows: "currents" are shares of the largest command, so that
// the limits are 1 and FalconModel::continuous_share.
//
// Thread, RT, Ownership: as HapticDevice; no allocation after the constructor.
// Errors: read() gives NoData while it boots and when no whole reply came, ProtocolError when only
// bytes of none came (counted as malformed, as they are beside a reply, and so is a reference that
// was lost), Disconnected when the bus is lost. write() gives Backlogged for every step of the boot
// and while an answer is owed, and then drops the command: the next tick has a newer one; else what
// the bus says. A request that never ends: above.
class FalconDevice final : public HapticDevice {
 public:
  struct Settings {
    double newton_per_count{};        // as FalconModel's; > 0, else a broken invariant
    std::vector<std::uint8_t> image;  // of the firmware; empty: none
    // That of the bus, and it must outlive the device; nullptr: time is that of packets alone.
    const Clock* clock{nullptr};
  };

  // `model` must outlive the device; those of the table do.
  FalconDevice(std::unique_ptr<bus::UsbDevice> bus, const FalconModel& model, Settings settings);
  ~FalconDevice() override;
  FalconDevice(const FalconDevice&) = delete;
  FalconDevice& operator=(const FalconDevice&) = delete;

  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override;
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override;
  [[nodiscard]] DeviceCounters counters() const noexcept override;
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override;
  THIMBLE_RT void forget_calibration() noexcept override;
  THIMBLE_RT_IO IoStatus read(HapticState& out) noexcept override;
  THIMBLE_RT_IO IoStatus write(const LimitedWrench& wrench) noexcept override;

  // Ours: the stops in the table are, too.
  static constexpr double kStopSlack_rad = 0.3;
  // Ours: three latency periods of a bridge that boots.
  static constexpr Duration kSilentPipe = std::chrono::milliseconds(50);

 private:
  // This driver as a shared object (falcon_plugin.cpp): a force that comes to it has been through
  // the host's limiter and has left its type behind at the boundary, which is plain C. Nobody else
  // may name a force that is not a LimitedWrench.
  friend class HostedFalcon;
  THIMBLE_RT_IO IoStatus drive(Force3 force) noexcept;

  using MotorCounts = std::array<std::int16_t, 3>;

  IoStatus take_packets() noexcept;
  void pass_silence() noexcept;
  void take_run_bytes(std::span<const std::uint8_t> serial) noexcept;
  void lose_reference() noexcept;
  [[nodiscard]] bool take_pose(const RunReport& report) noexcept;
  void fill(HapticState& out, const RunReport& report) noexcept;
  void start_over() noexcept;
  void publish() noexcept;
  IoStatus carry_out(const BootOrder& order) noexcept;
  [[nodiscard]] MotorCounts motors_for(Force3 force) const noexcept;

  std::unique_ptr<bus::UsbDevice> bus_;
  const Clock* clock_;
  std::vector<std::uint8_t> image_;
  FalconKinematics kinematics_;
  HapticCapabilities capabilities_;
  BootSequence boot_;
  ArmReference reference_;
  ExchangePacer pacer_;
  RunParser parser_;
  ArmPose middle_;
  ArmPose pose_;
  bus::UsbPacket packet_{};
  std::optional<RunReport> fresh_;
  bool is_loss_untold_{false};             // the reference was lost, and no state has said so
  MonotonicTime now_{};                    // of the newest packet, or of the clock since
  std::optional<MonotonicTime> heard_at_;  // the newest packet, or the first look
  MonotonicTime reported_at_{};
  bool is_given_up_{false};
  std::uint64_t lost_bytes_seen_{0};
  MotorCounts sent_counts_{};
  // Read from any thread.
  std::atomic<bool> has_heard_{false};
  std::atomic<BootStage> stage_{BootStage::Detecting};
  std::atomic<BootTrouble> trouble_{BootTrouble::None};
  std::atomic<CalibrationState> calibration_{CalibrationState::Unknown};
  std::atomic<std::uint64_t> reports_{0};
  std::atomic<std::uint64_t> skipped_{0};
  std::atomic<std::uint64_t> malformed_{0};
};

}  // namespace thimble::falcon
