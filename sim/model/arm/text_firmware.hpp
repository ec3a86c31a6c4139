#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/phantom/text_wire.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/arm/controller_board.hpp"

namespace thimble::sim {

struct TextFirmwareCounters {
  std::uint64_t messages_taken{0};
  std::uint64_t messages_refused{0};  // answered with an error
  std::uint64_t cut_to_zero{0};       // currents beyond full scale
  std::uint64_t watchdog_trips{0};
  bool operator==(const TextFirmwareCounters&) const = default;
};

// The WoodenHaptics-family controller board on a Teensy, text variant (arms.md 3.1): a loop that
// waits for a message, acts on it and answers, once. It takes no time. What it has to say waits
// without bound for a host that reads; the loop waits with it, as the board's does in its write.
//
// The watchdog is a timer interrupt and runs all the time.
//
// Thread: one. RT: all but the constructor. Errors: none: any bytes are taken, answered as the
// board would, and counted.
class TextFirmware final : public ControllerBoard {
 public:
  struct Settings {
    std::int32_t build_number{0};
    double full_scale_a{phantom::text::kAmplifierMaxA};
    Duration pwm_phase{0};
    // Wants its button pressed before it is used, and makes up counters until then.
    bool is_calibration_wanted{false};
  };

  explicit TextFirmware(const Settings& settings) noexcept;

  THIMBLE_RT void power_up(MonotonicTime t, Duration boot,
                           const EncoderTotals& totals) noexcept override;
  THIMBLE_RT void run_until(MonotonicTime t, const EncoderTotals& totals) noexcept override;
  // The pressing edge makes all counters zero at the next run_until().
  THIMBLE_RT void set_calibration_button(bool pressed) noexcept override;
  THIMBLE_RT void set_stylus_button(bool /*pressed*/) noexcept override {}  // it has none
  [[nodiscard]] const MotorAmplifier& amplifier() const noexcept override { return amplifier_; }

  // The line's side. How many of `bytes` there was room for; they are read by the next run_until().
  THIMBLE_RT std::size_t take(std::span<const std::uint8_t> bytes) noexcept;
  THIMBLE_RT std::size_t give(std::span<std::uint8_t> out) noexcept;
  // Something was taken that it has not read, which may be answered.
  [[nodiscard]] bool has_unread() const noexcept { return in_read_ < in_size_; }
  // Something that give() would say.
  [[nodiscard]] bool has_unsaid() const noexcept { return out_size_ > 0; }
  [[nodiscard]] const TextFirmwareCounters& counters() const noexcept { return counters_; }

 private:
  // Ours: what the board's USB stack keeps of what was not read, and of what was not sent.
  static constexpr std::size_t kInRoom = 512;
  static constexpr std::size_t kOutRoom = 512;
  static constexpr std::size_t kLongestAnswer = 100;

  THIMBLE_RT void read_waiting(MonotonicTime t, const EncoderTotals& totals) noexcept;
  THIMBLE_RT void end_message(MonotonicTime t, const EncoderTotals& totals) noexcept;
  THIMBLE_RT bool discard_rest() noexcept;
  THIMBLE_RT void obey(MonotonicTime t, const std::array<std::int32_t, 3>& milliampere) noexcept;
  THIMBLE_RT void answer(std::int32_t error) noexcept;
  THIMBLE_RT void start_message() noexcept;

  Settings settings_;
  MotorAmplifier amplifier_;
  TextFirmwareCounters counters_{};
  MonotonicTime deaf_until_{};
  MonotonicTime watchdog_at_{};
  bool is_watchdog_set_{false};
  EncoderTotals zero_{};
  std::array<std::int64_t, phantom::text::kCounterCount> told_{};  // what a refusal repeats
  bool is_button_down_{false};
  bool is_press_new_{false};
  bool is_calibration_wanted_{false};
  std::int64_t faked_{0};  // answers so far with made-up counters
  std::int32_t faked_echo_{0};

  std::array<char, phantom::text::kBufferBytes> message_{};
  std::size_t message_size_{0};
  std::size_t start_{0};
  bool has_start_{false};
  int commas_{0};

  std::array<std::uint8_t, kInRoom> in_{};
  std::size_t in_size_{0};
  std::size_t in_read_{0};
  std::array<std::uint8_t, kOutRoom> out_{};
  std::size_t out_size_{0};
};

}  // namespace thimble::sim
