#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hal/base/geometry.hpp"
#include "hal/base/io_status.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/device/limited_wrench.hpp"
#include "hal/device/zero_command.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble {

inline constexpr std::size_t kMaxJoints = 6;
// Where the gimbal's angles stand among the joints: behind the three that carry the tip.
inline constexpr std::size_t kFirstGimbalJoint = 3;

enum class CalibrationState : std::uint8_t {
  Unknown,    // the counters mean nothing yet
  NeedsUser,  // a person must do what calibration_instruction() says
  Ok,         // is_homed in CRTK's words
};
std::string_view to_string(CalibrationState state) noexcept;

// What an arm can do; constant while the device is open. Force limits are those of the
// arm's data sheet at the tip; 0 means "not known", and then the configuration must give it.
struct HapticCapabilities {
  std::string model;
  std::size_t joint_count{3};  // 3: the tip only; 6: a gimbal, too, whose angles are measured
  bool is_actuated{true};      // false: it has no motors, and the limits below are not there
  double peak_force_newton{0};
  double continuous_force_newton{0};
  double max_stiffness_newton_per_m{0};  // at 1 kHz
  double workspace_radius_m{0};
  // An arm whose amperes nobody knows says shares of its largest command here and in the state.
  std::array<double, 3> peak_current_a{};        // per motor: the clamp of the limiter
  std::array<double, 3> continuous_current_a{};  // per motor: its thermal limit
  // Per motor: what a newton asks for at most anywhere in the workspace, so that an arm which lies
  // about its pose moves no motor by more (decision 0492); 0: no bound but the peak.
  std::array<double, 3> most_current_a_per_newton{};
  Duration sample_period{};  // of the device's own reports
  // Ticks of the servo a second from which on no sample is left out: what is driven at where a
  // person says no rate (decision 0491).
  double full_rate_hz{1000};
  Duration device_watchdog{};  // 0: none or unknown
  bool operator==(const HapticCapabilities&) const = default;
};

// One measured state. Base frame of the arm: x right, y up, z towards the user; its origin is
// the driver's choice, in the middle of the workspace (docs/architecture.md draws the frame,
// the driver's README says where the origin is). Until calibration is Ok the tip means nothing.
struct HapticState {
  MonotonicTime sampled_at{};        // when its report reached the host, clock of the bus
  std::uint64_t sample_sequence{0};  // +1 for every report of the device
  // 0 to 2 carry the tip (the driver's README draws them). 3 to 5 are the gimbal's axes, in -π to
  // π: each about its own axis, 0 as the stylus was held while the arm was calibrated. Angles, not
  // an orientation in the base frame. Beyond joint_count, and until calibrated: 0.
  std::array<double, kMaxJoints> joint_position_rad{};
  Position3 tip{};
  // Motor currents [A] for a force [N] at the tip in this pose: I = M · F.
  Matrix3 motor_current_per_force{};
  std::uint32_t buttons{0};  // bit 0: stylus button; further ones: the driver's header
  CalibrationState calibration{CalibrationState::Unknown};
};

// Since the device was opened; none ever falls. Read while the servo drives it.
struct DeviceCounters {
  std::uint64_t reports_in{0};
  std::uint64_t reports_skipped{0};
  std::uint64_t malformed{0};
  std::uint64_t commands_out{0};
  std::uint64_t commands_superseded{0};

  DeviceCounters& operator+=(const DeviceCounters& other) noexcept {
    reports_in += other.reports_in;
    reports_skipped += other.reports_skipped;
    malformed += other.malformed;
    commands_out += other.commands_out;
    commands_superseded += other.commands_superseded;
    return *this;
  }
};

// A force-feedback arm, opened by a driver on some bus, real or simulated.
//
// Thread: read(), write() and forget_calibration() from the servo thread (the last also from
//         any non-RT thread before the servo has the device); the rest from the one control
//         thread that owns it; made and ended by any thread, while no other one uses it.
// RT: read() and write() are THIMBLE_RT_IO and make no call but their bus's exchange.
// Ownership: owns its bus device. The destructor submits a zero command, but nobody waits for
//            it to leave: who wants zero to arrive writes it for a few sample periods before.
// Errors: IoStatus; Disconnected latches.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  [[nodiscard]] virtual const HapticCapabilities& capabilities() const noexcept = 0;
  // What a person must do now, one sentence; empty when calibrated.
  [[nodiscard]] virtual std::string_view calibration_instruction() const noexcept = 0;
  [[nodiscard]] virtual DeviceCounters counters() const noexcept = 0;
  // Constant while the device is open. Nothing: this arm cannot be guarded, and one that needs a
  // guard is then refused.
  [[nodiscard]] virtual std::optional<ZeroCommand> zero_command() const noexcept = 0;

  // Discards the old reference; the arm must be calibrated again (a returned arm always).
  THIMBLE_RT virtual void forget_calibration() noexcept = 0;

  // Ok: `out` is a fresh sample. NoData: untouched. Disconnected, ProtocolError: untouched.
  THIMBLE_RT_IO virtual IoStatus read(HapticState& out) noexcept = 0;
  // Ok: the bus took it. Backlogged: the last one is still on its way (normal when the servo is
  // faster than the bus), or failed; this one waits, or is dropped by a device that is asked only
  // when it has answered: who wants it to arrive writes on. Disconnected, ProtocolError: nothing
  // was sent. The arm exerts the wrench until the next write or its own watchdog. Before
  // calibration the device sends zero whatever is asked: no force without a known pose.
  THIMBLE_RT_IO virtual IoStatus write(const LimitedWrench& wrench) noexcept = 0;
};

}  // namespace thimble
