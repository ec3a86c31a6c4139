#include "sim/model/arm/controller_firmware.hpp"

#include <algorithm>
#include <limits>

#include "drivers/phantom/phantom_wire.hpp"

namespace thimble::sim {
namespace {

namespace wire = phantom::wire;

constexpr double kAmperesPerStep = 0.001;  // arms.md 3.1: currents in mA
constexpr MonotonicTime kNever{Duration{std::numeric_limits<std::int64_t>::max()}};

}  // namespace

ControllerFirmware::ControllerFirmware(const Settings& settings) noexcept
    : settings_(settings), amplifier_(settings.amplifier_max_a, settings.pwm_phase) {}

void ControllerFirmware::power_up(MonotonicTime t, Duration boot,
                                  const EncoderTotals& totals) noexcept {
  amplifier_.power_up(t);
  state_ = State::Booting;
  boot_ends_at_ = t + boot;
  watchdog_at_ = kNever;
  has_button_flag_ = false;
  has_host_report_ = false;
  zero_ = totals;
}

MonotonicTime ControllerFirmware::host_report_ready_at() const noexcept {
  if (state_ != State::Waiting || !has_host_report_) return kNever;
  return std::max(host_report_complete_at_, resumes_at_);
}

MonotonicTime ControllerFirmware::next_event() const noexcept {
  if (state_ == State::Booting) return boot_ends_at_;
  return std::min(host_report_ready_at(), watchdog_at_);
}

void ControllerFirmware::run_until(MonotonicTime t, const EncoderTotals& totals) noexcept {
  // Each event removes its own cause, so this ends after boot, watchdog and one host report.
  while (next_event() <= t) {
    const MonotonicTime event = next_event();
    amplifier_.run_until(event);
    if (state_ == State::Booting) {
      // Encoder interrupts are enabled only now: what the arm moved before is not counted.
      zero_ = totals;
      send(totals);
    } else if (watchdog_at_ <= event) {  // at the same instant the interrupt goes first
      amplifier_.disable();
      watchdog_at_ = kNever;
      ++counters_.watchdog_trips;
    } else {
      handle_host_report(event, totals);
      send(totals);
    }
  }
  amplifier_.run_until(t);
}

void ControllerFirmware::send(const EncoderTotals& totals) noexcept {
  const auto put = [this](std::size_t field, std::int64_t value) noexcept {
    // The board's counters are wider than the field: the low 16 bits go out, and so they wrap.
    const auto low = static_cast<std::uint16_t>(static_cast<std::uint64_t>(value) & 0xffffU);
    report_[2 * field] = static_cast<std::uint8_t>(low & 0xffU);
    report_[2 * field + 1] = static_cast<std::uint8_t>(low >> 8U);
  };
  for (std::size_t i = 0; i < totals.size(); ++i) put(wire::kEncoderA + i, totals[i] - zero_[i]);
  if (settings_.is_teensy && is_stylus_pressed_) {
    put(wire::kEncoderD, totals[3] - zero_[3] + wire::kButtonFold);
  }
  put(wire::kInfo, has_button_flag_ ? wire::kInfoCalibrationPressed : 0);
  state_ = State::Sending;
}

std::int16_t ControllerFirmware::host_field(std::size_t index) const noexcept {
  const auto low = static_cast<unsigned>(host_report_[2 * index]);
  const auto high = static_cast<unsigned>(host_report_[2 * index + 1]);
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
}

void ControllerFirmware::handle_host_report(MonotonicTime t, const EncoderTotals& totals) noexcept {
  has_host_report_ = false;
  if (host_report_bytes_ != report_bytes()) {
    ++counters_.wrong_length;
    return;
  }
  ++counters_.reports_handled;
  watchdog_at_ = t + wire::kWatchdog;
  amplifier_.enable();
  const std::int16_t command = host_field(wire::kCommand);
  if (command == wire::kCommandSetCounters) {
    set_counters(totals);
    amplifier_.write_current(t, {});
    return;
  }
  if (command != wire::kCommandCurrents) ++counters_.unknown_command;
  amplifier_.write_current(t, {kAmperesPerStep * host_field(wire::kCurrentA),
                               kAmperesPerStep * host_field(wire::kCurrentA + 1),
                               kAmperesPerStep * host_field(wire::kCurrentA + 2)});
}

void ControllerFirmware::set_counters(const EncoderTotals& totals) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    zero_[i] = totals[i] - host_field(wire::kAttribute0 + i);
    zero_[3 + i] = totals[3 + i] - host_field(wire::kCurrentA + i);
  }
  has_button_flag_ = false;
}

void ControllerFirmware::out_report(MonotonicTime t, std::span<const std::uint8_t> bytes) noexcept {
  if (state_ == State::Booting) {
    ++counters_.sent_while_off;
    return;
  }
  if (has_host_report_) ++counters_.superseded;
  host_report_bytes_ = bytes.size();
  std::copy_n(bytes.begin(), std::min(bytes.size(), host_report_.size()), host_report_.begin());
  has_host_report_ = true;
  host_report_complete_at_ = t + settings_.frame_period;
}

std::size_t ControllerFirmware::in_report(MonotonicTime t, std::span<std::uint8_t> out) noexcept {
  if (state_ != State::Sending || out.size() < report_bytes()) return 0;
  std::copy_n(report_.begin(), report_bytes(), out.begin());
  state_ = State::Waiting;
  resumes_at_ = t + settings_.frame_period;
  ++counters_.reports_sent;
  return report_bytes();
}

std::size_t ControllerFirmware::report_bytes() const noexcept {
  return settings_.is_teensy ? wire::kTeensyReportBytes : wire::kMbedReportBytes;
}

void ControllerFirmware::set_calibration_button(bool pressed) noexcept {
  if (pressed && !is_button_down_ && state_ != State::Booting) has_button_flag_ = true;
  is_button_down_ = pressed;
}

FirmwareCounters ControllerFirmware::counters() const noexcept {
  FirmwareCounters all = counters_;
  all.saturations = amplifier_.saturations();
  return all;
}

}  // namespace thimble::sim
