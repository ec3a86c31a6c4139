#include "sim/model/arm/text_firmware.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>

#include "sim/model/arm/text_message.hpp"

namespace thimble::sim {
namespace {

namespace text = phantom::text;

constexpr MotorAmplifier::Pwm kPwm{from_seconds(1 / text::kPwmHz), 8192};  // 13 bits
constexpr double kAmperesPerStep = 0.001;

}  // namespace

TextFirmware::TextFirmware(const Settings& settings) noexcept
    : settings_(settings), amplifier_(settings.full_scale_a, settings.pwm_phase, kPwm) {}

void TextFirmware::power_up(MonotonicTime t, Duration boot, const EncoderTotals& totals) noexcept {
  amplifier_.power_up(t);
  deaf_until_ = t + boot;
  is_watchdog_set_ = false;
  zero_ = totals;
  told_ = {};
  is_press_new_ = false;
  is_calibration_wanted_ = settings_.is_calibration_wanted;
  faked_ = 0;
  start_message();
  in_size_ = in_read_ = out_size_ = 0;
}

void TextFirmware::set_calibration_button(bool pressed) noexcept {
  is_press_new_ = is_press_new_ || (pressed && !is_button_down_);
  is_button_down_ = pressed;
}

void TextFirmware::run_until(MonotonicTime t, const EncoderTotals& totals) noexcept {
  if (is_watchdog_set_ && watchdog_at_ <= t) {
    amplifier_.run_until(watchdog_at_);
    amplifier_.disable();
    is_watchdog_set_ = false;
    ++counters_.watchdog_trips;
  }
  amplifier_.run_until(t);
  if (t < deaf_until_) {
    zero_ = totals;
    return;
  }
  if (is_press_new_) {
    is_press_new_ = false;
    zero_ = totals;
    told_ = {};
    is_calibration_wanted_ = false;
  }
  read_waiting(t, totals);
}

// Once round the board's loop for each message.
void TextFirmware::read_waiting(MonotonicTime t, const EncoderTotals& totals) noexcept {
  while (in_read_ < in_size_ && out_size_ + kLongestAnswer <= out_.size()) {
    const char letter = static_cast<char>(in_[in_read_++]);
    message_[message_size_++] = letter;
    if (letter == ']') {
      end_message(t, totals);
      start_message();
      continue;
    }
    if (letter == '[') {
      has_start_ = true;
      start_ = message_size_ - 1;
    }
    if (letter == ',') ++commas_;
    if (message_size_ < text::kBufferBytes) continue;
    answer(text::kErrorBufferFull);
    start_message();
  }
  if (in_read_ == in_size_) in_read_ = in_size_ = 0;
}

void TextFirmware::start_message() noexcept {
  message_ = {};
  message_size_ = 0;
  start_ = 0;
  has_start_ = false;
  commas_ = 0;
}

// What has arrived behind the bracket is thrown away; a message among it is an error.
bool TextFirmware::discard_rest() noexcept {
  while (in_read_ < in_size_) {
    const char letter = static_cast<char>(in_[in_read_++]);
    if (letter != '\n' && letter != '\r' && letter != '\0') return false;
  }
  return true;
}

void TextFirmware::end_message(MonotonicTime t, const EncoderTotals& totals) noexcept {
  if (!has_start_) return answer(text::kErrorNoStart);
  if (commas_ != 2) return answer(text::kErrorFieldCount);
  if (!discard_rest()) return answer(text::kErrorTrailing);
  const std::string_view message(message_.data() + start_, message_size_ - start_);
  const auto milliampere = scan_currents(message);
  if (!milliampere) return answer(text::kErrorParse);
  ++counters_.messages_taken;
  obey(t, *milliampere);
  for (std::size_t i = 0; i < 3; ++i) told_[i] = totals[i] - zero_[i];
  faked_echo_ = (*milliampere)[0];
  answer(0);
}

void TextFirmware::obey(MonotonicTime t, const std::array<std::int32_t, 3>& milliampere) noexcept {
  if (is_calibration_wanted_) {
    amplifier_.disable();
    is_watchdog_set_ = false;
    return;
  }
  watchdog_at_ = t + text::kWatchdog;
  is_watchdog_set_ = true;
  amplifier_.enable();
  std::array<double, 3> current_a{};
  for (std::size_t i = 0; i < 3; ++i) {
    current_a[i] = kAmperesPerStep * milliampere[i];
    if (std::abs(current_a[i]) <= settings_.full_scale_a) continue;
    current_a[i] = 0;
    ++counters_.cut_to_zero;
  }
  amplifier_.write_current(t, current_a);
}

void TextFirmware::answer(std::int32_t error) noexcept {
  if (error != 0) ++counters_.messages_refused;
  auto counts = told_;
  if (error == 0 && is_calibration_wanted_) {
    const double phase_rad = text::kFakedStep_rad * static_cast<double>(faked_++);
    counts[0] =
        std::lround(text::kFakedMiddle_counts + text::kFakedSwing_counts * std::sin(phase_rad));
    counts[1] = faked_echo_;
  }
  std::array<char, kLongestAnswer + 1> line{};
  const int size = std::snprintf(
      line.data(), line.size(), "[%d,%d,%d,%d,%d,%d,%d,%d]\n", settings_.build_number,
      static_cast<int>(counts[0]), static_cast<int>(counts[1]), static_cast<int>(counts[2]),
      static_cast<int>(counts[3]), static_cast<int>(counts[4]), static_cast<int>(counts[5]), error);
  const auto end = line.begin() + std::min<std::ptrdiff_t>(size, kLongestAnswer);
  std::copy(line.begin(), end, out_.begin() + static_cast<std::ptrdiff_t>(out_size_));
  out_size_ += static_cast<std::size_t>(end - line.begin());
}

std::size_t TextFirmware::take(std::span<const std::uint8_t> bytes) noexcept {
  const std::size_t size = std::min(bytes.size(), in_.size() - in_size_);
  std::copy_n(bytes.begin(), size, in_.begin() + static_cast<std::ptrdiff_t>(in_size_));
  in_size_ += size;
  return size;
}

std::size_t TextFirmware::give(std::span<std::uint8_t> out) noexcept {
  const std::size_t size = std::min(out.size(), out_size_);
  std::copy_n(out_.begin(), size, out.begin());
  std::copy(out_.begin() + static_cast<std::ptrdiff_t>(size),
            out_.begin() + static_cast<std::ptrdiff_t>(out_size_), out_.begin());
  out_size_ -= size;
  return size;
}

}  // namespace thimble::sim
