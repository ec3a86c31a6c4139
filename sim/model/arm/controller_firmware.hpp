#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/time.hpp"
#include "hal/bus/hid_device.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/arm/controller_board.hpp"

namespace thimble::sim {

// What the firmware did and what it was asked that it cannot do.
struct FirmwareCounters {
  std::uint64_t reports_sent{0};
  std::uint64_t reports_handled{0};
  std::uint64_t wrong_length{0};  // host reports of another length than the board's: without effect
  std::uint64_t superseded{0};    // host reports drained unread because a newer one was there
  std::uint64_t unknown_command{0};  // neither 0 nor 1: the firmware takes them as currents
  std::uint64_t watchdog_trips{0};
  std::uint64_t saturations{0};     // motor commands beyond full scale
  std::uint64_t sent_while_off{0};  // host reports lost because the board was booting
  bool operator==(const FirmwareCounters&) const = default;
};

// The WoodenHaptics-family controller board, HID variant (arms.md 3.1), as a state machine:
//
//   Booting --1 s--> Sending --host took the report--> Waiting --host report--> Sending …
//
// It talks in lock-step: one report, then it waits, without end, for one host report. A host
// that hears nothing must send one to get the exchange going; the board never repeats itself.
// A report of USB frame n, either way, is complete when frame n ends: no motor moves, and
// nothing is answered, before frame n+1. The watchdog is a timer interrupt and runs in every state.
//
// Thread: one. RT: all but the constructor. Errors: none: any bytes are taken, ignored or
// misunderstood as the board would, and counted.
class ControllerFirmware final : public ControllerBoard {
 public:
  struct Settings {
    double amplifier_max_a{3};
    Duration frame_period{1'000'000};
    Duration pwm_phase{0};
    // The Teensy build: reports of 64 bytes, the stylus button folded into counter d. Else the
    // mbed build: 14 bytes, no such button.
    bool is_teensy{false};
  };
  enum class State : std::uint8_t { Booting, Sending, Waiting };

  explicit ControllerFirmware(const Settings& settings) noexcept;

  // Counters are zero at whatever pose the arm has now. `boot`: how long it blinks its LEDs.
  THIMBLE_RT void power_up(MonotonicTime t, Duration boot,
                           const EncoderTotals& totals) noexcept override;
  // When something is to be done next, if nothing happens before.
  THIMBLE_RT [[nodiscard]] MonotonicTime next_event() const noexcept;
  // Does everything that falls due until `t`, with the encoders as they are at `t`.
  THIMBLE_RT void run_until(MonotonicTime t, const EncoderTotals& totals) noexcept override;

  // USB side, at the frame that begins at `t`.
  THIMBLE_RT void out_report(MonotonicTime t, std::span<const std::uint8_t> bytes) noexcept;
  THIMBLE_RT std::size_t in_report(MonotonicTime t, std::span<std::uint8_t> out) noexcept;

  // The calibration button's pin; its pressing edge sets the flag that reports carry.
  THIMBLE_RT void set_calibration_button(bool pressed) noexcept override;
  // The level of the stylus button; without effect on the mbed build.
  THIMBLE_RT void set_stylus_button(bool pressed) noexcept override {
    is_stylus_pressed_ = pressed;
  }
  [[nodiscard]] std::size_t report_bytes() const noexcept;

  [[nodiscard]] State state() const noexcept { return state_; }
  [[nodiscard]] const MotorAmplifier& amplifier() const noexcept override { return amplifier_; }
  [[nodiscard]] FirmwareCounters counters() const noexcept;

 private:
  void send(const EncoderTotals& totals) noexcept;
  void handle_host_report(MonotonicTime t, const EncoderTotals& totals) noexcept;
  void set_counters(const EncoderTotals& totals) noexcept;
  [[nodiscard]] std::int16_t host_field(std::size_t index) const noexcept;
  [[nodiscard]] MonotonicTime host_report_ready_at() const noexcept;

  Settings settings_;
  MotorAmplifier amplifier_;
  State state_{State::Booting};
  FirmwareCounters counters_{};

  MonotonicTime boot_ends_at_{};
  MonotonicTime resumes_at_{};  // when the frame that took our report is over
  MonotonicTime watchdog_at_{};
  EncoderTotals zero_{};  // total at which each counter reads 0
  bool is_button_down_{false};
  bool has_button_flag_{false};
  bool is_stylus_pressed_{false};

  std::array<std::uint8_t, bus::kMaxHidReportBytes> host_report_{};
  std::size_t host_report_bytes_{0};
  bool has_host_report_{false};
  MonotonicTime host_report_complete_at_{};
  std::array<std::uint8_t, bus::kMaxHidReportBytes> report_{};
};

}  // namespace thimble::sim
