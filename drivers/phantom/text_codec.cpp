#include "drivers/phantom/text_codec.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace thimble::phantom {
namespace {

bool is_padding(std::uint8_t byte) noexcept { return byte == '\n' || byte == '\r' || byte == 0; }

void append(TextMessage& message, char letter) noexcept {
  message.bytes[message.size++] = static_cast<std::uint8_t>(letter);
}

void append(TextMessage& message, std::int32_t value) noexcept {
  std::array<char, 12> digits{};
  const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  for (const char* digit = digits.data(); digit != written.ptr; ++digit) append(message, *digit);
}

std::int32_t to_milliampere(double current_a, double full_scale_a) noexcept {
  if (!std::isfinite(current_a)) return 0;
  // Rounded down, but not for a decimal fraction that a double falls short of.
  const double limit = std::floor(full_scale_a * 1000 + 1e-6);
  return static_cast<std::int32_t>(std::lround(std::clamp(current_a * 1000, -limit, limit)));
}

}  // namespace

std::optional<TextReport> parse_text_report(std::span<const std::uint8_t> line) noexcept {
  if (line.size() < 2 || line.front() != '[' || line.back() != ']') return std::nullopt;
  std::array<std::int32_t, text::kFieldCount> field{};
  const char* next = reinterpret_cast<const char*>(line.data()) + 1;
  const char* const end = reinterpret_cast<const char*>(line.data()) + line.size();
  for (std::size_t i = 0; i < field.size(); ++i) {
    // "%d" writes no more digits than it must.
    const char* const first = *next == '-' ? next + 1 : next;
    if (*first == '0' && (first != next || (first[1] >= '0' && first[1] <= '9'))) {
      return std::nullopt;
    }
    const auto [stop, error] = std::from_chars(next, end, field[i]);
    const bool is_last = i + 1 == field.size();
    if (error != std::errc() || *stop != (is_last ? ']' : ',')) return std::nullopt;
    next = stop + 1;
  }
  if (next != end) return std::nullopt;
  TextReport report;
  report.model = field.front();
  std::copy_n(field.begin() + 1, report.counts.size(), report.counts.begin());
  report.error = field.back();
  return report;
}

TextMessage encode_text_currents(const std::array<double, 3>& current_a,
                                 double full_scale_a) noexcept {
  TextMessage message;
  append(message, text::kToLose);
  append(message, '[');
  for (std::size_t i = 0; i < current_a.size(); ++i) {
    if (i > 0) append(message, ',');
    append(message, to_milliampere(current_a[i], full_scale_a));
  }
  append(message, ']');
  append(message, '\n');
  message.size = std::max(message.size, text::kShortestMessageBytes);
  return message;
}

std::span<const std::uint8_t> TextLines::take(std::uint8_t byte) noexcept {
  if (byte == '[') {
    lost_bytes_ += size_;
    size_ = 0;
  } else if (size_ == 0) {
    lost_bytes_ += is_padding(byte) ? 0U : 1U;
    return {};
  }
  if (size_ == line_.size()) {
    lost_bytes_ += size_ + 1;
    size_ = 0;
    return {};
  }
  line_[size_++] = byte;
  if (byte != ']') return {};
  return {line_.data(), std::exchange(size_, 0)};
}

void TextLines::forget() noexcept { lost_bytes_ += std::exchange(size_, 0); }

}  // namespace thimble::phantom
