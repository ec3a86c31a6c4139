#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "hal/base/check.hpp"
#include "hal/base/time.hpp"
#include "hal/device/haptic_device.hpp"
#include "tests/support/made_wrench.hpp"

namespace thimble::fuzz {

// As late as the device says.
class WireClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override { return now_; }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    now_ = std::max(now_, deadline);
    return {};
  }

 private:
  MonotonicTime now_{std::chrono::seconds(1)};
};

// What happens on a wire, out of the input: a byte of 0 to 123 is so many ms and then a packet, of
// which the next byte is the length; 124 to 127 are kinds of trouble; from 128 on 0 to 127 ms
// without a packet.
enum class WireEvent : std::uint8_t { End, Nothing, Packet, Trouble };
enum class WireTrouble : std::uint8_t { Disconnected, Refused, Silent, Broken };
class WireScript {
 public:
  explicit WireScript(std::span<const std::uint8_t> rest) : rest_(rest) {}
  [[nodiscard]] bool is_at_end() const noexcept { return rest_.size() < 2; }
  // Some ticks more than the input has something for, and not for ever.
  [[nodiscard]] bool goes_on(int tick) const noexcept {
    return tick < 20 || (!is_at_end() && tick < 4000);
  }
  // `room`: where a packet goes; what does not fit is cut.
  WireEvent next(WireClock& clock, std::span<std::uint8_t> room, std::size_t& size) noexcept {
    if (is_at_end()) return WireEvent::End;
    const std::uint8_t first = rest_[0];
    if (first >= kFirstTrouble && first <= kMost) {
      trouble = static_cast<WireTrouble>(first - kFirstTrouble);
      rest_ = rest_.subspan(1);
      return WireEvent::Trouble;
    }
    clock.sleep_until(clock.now() + (first & kMost) * std::chrono::milliseconds(1));
    if (first > kMost) {
      rest_ = rest_.subspan(1);
      return WireEvent::Nothing;
    }
    size = std::min<std::size_t>({rest_[1] % 65U, rest_.size() - 2, room.size()});
    std::copy_n(rest_.begin() + 2, size, room.begin());
    rest_ = rest_.subspan(2 + size);
    return WireEvent::Packet;
  }
  WireTrouble trouble{};  // the newest

 private:
  static constexpr std::uint8_t kFirstTrouble = 124;
  static constexpr std::uint8_t kMost = 127;
  std::span<const std::uint8_t> rest_;
};

inline void require_sane(const HapticState& state) {
  THIMBLE_CHECK(is_finite(state.tip));
  for (const double angle_rad : state.joint_position_rad) THIMBLE_CHECK(std::isfinite(angle_rad));
  for (std::size_t i = kFirstGimbalJoint; i < state.joint_position_rad.size(); ++i) {
    THIMBLE_CHECK(std::abs(state.joint_position_rad[i]) <= std::numbers::pi);
  }
  for (const auto& row : state.motor_current_per_force.row) {
    for (const double share : row) THIMBLE_CHECK(std::isfinite(share));
  }
}

// One tick of an arm that is asked for far too much: reads, judges what came and notes whether the
// motors may be told anything.
inline IoStatus push_for_a_tick(HapticDevice& arm, bool& may_push) {
  HapticState state;
  const IoStatus status = arm.read(state);
  if (status == IoStatus::Disconnected) may_push = false;
  if (status == IoStatus::Ok) {
    may_push = state.calibration == CalibrationState::Ok;
    require_sane(state);
  }
  static_cast<void>(arm.write(servo::WrenchLimiter::make({1e6, -1e6, 1e6})));
  return status;
}

}  // namespace thimble::fuzz
