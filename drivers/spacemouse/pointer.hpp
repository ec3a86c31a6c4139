#pragma once

#include <array>
#include <cstdint>

#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::spacemouse {

// A point that a puck drives: how far it is pushed says how fast the point moves, and where to.
//
// A puck tells changes only as long as it is deflected, so one that has been silent for kSilence
// is taken as let go: a lost last report must not send the point away for ever. The reference is
// the centre: the point starts there, once the puck was seen, or believed, to be let go for
// kSettle.
//
// Thread: one. RT: all THIMBLE_RT. A value. Errors: none, whatever the puck says.
class Pointer {
 public:
  explicit Pointer(double full_deflection_counts) noexcept : full_counts_(full_deflection_counts) {}

  THIMBLE_RT void forget() noexcept;
  // The puck's axes as on the wire: right, towards the person, down; in the base frame (x, -z, y).
  // A turn moves nothing, but a puck that is turned is not let go.
  THIMBLE_RT void push(const std::array<std::int16_t, 3>& counts, MonotonicTime at) noexcept;
  THIMBLE_RT void turn(const std::array<std::int16_t, 3>& counts, MonotonicTime at) noexcept;
  // Moves the point up to `now`.
  THIMBLE_RT void advance(MonotonicTime now) noexcept;

  // Base frame: x right, y up, z towards the person.
  [[nodiscard]] Position3 position() const noexcept { return position_; }
  [[nodiscard]] CalibrationState calibration() const noexcept { return calibration_; }

  // All ours. A hand's pace when exploring: the whole way in about a second.
  static constexpr double kFullSpeed_m_per_s = 0.15;
  static constexpr double kRadius_m = 0.1;
  static constexpr Duration kSilence = std::chrono::milliseconds(100);  // 6 reports of a slow puck
  static constexpr Duration kSettle = std::chrono::milliseconds(50);    // 3 of them
  // A tick that comes later than this moves the point no further: 3 mm at most, no leap.
  static constexpr Duration kLongestStep = std::chrono::milliseconds(20);

 private:
  // -1 to 1: 0 within the dead band, 5 % of the full deflection (ours), then as the square, so that
  // small moves can be made.
  [[nodiscard]] double share(std::int16_t counts) const noexcept;
  [[nodiscard]] bool is_let_go() const noexcept;
  void settle(MonotonicTime now) noexcept;

  struct Deflection {
    std::array<std::int16_t, 3> counts{};
    MonotonicTime at{};
  };
  double full_counts_;
  Deflection push_{};
  Deflection turn_{};
  Position3 position_{};
  CalibrationState calibration_{CalibrationState::Unknown};
  MonotonicTime now_{};
  MonotonicTime let_go_since_{};
  bool is_started_{false};
};

}  // namespace thimble::spacemouse
