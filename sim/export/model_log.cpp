#include "sim/export/model_log.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace thimble::sim {
namespace {

constexpr std::array<std::string_view, 3> kDirections{"out", "in", "request"};

// Seven digits behind the point: 0.1 um, 0.1 mN, 0.1 us. By whole numbers, which cost a tenth of
// what printf takes: the log is told between the frames of a device that must not be late. JSON
// knows no NaN; what is beyond all sense is cut.
void append_number(std::string& text, double value) {
  constexpr std::int64_t kScale = 10'000'000;
  constexpr double kMost = 1e9;
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  const double cut = std::clamp(value, -kMost, kMost);
  const auto scaled = static_cast<std::int64_t>(std::llround(cut * static_cast<double>(kScale)));
  const std::int64_t size = scaled < 0 ? -scaled : scaled;
  std::array<char, 32> digits{};
  const auto whole = std::to_chars(digits.data(), digits.data() + digits.size(), size / kScale);
  // A one in front keeps the zeros behind the point.
  const auto end = std::to_chars(whole.ptr, digits.data() + digits.size(), kScale + size % kScale);
  *whole.ptr = '.';
  if (scaled < 0) text += '-';
  text.append(digits.data(), end.ptr);
}

template <class Three>
void append_triple(std::string& text, std::string_view name, const Three& value) {
  text += name;
  for (std::size_t i = 0; i < 3; ++i) {
    text += i == 0 ? '[' : ',';
    append_number(text, value[i]);
  }
  text += ']';
}

void append_hex(std::string& text, std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
}

}  // namespace

ModelLog::Entry& ModelLog::next() noexcept {
  return entries_[static_cast<std::size_t>(noted_++ % entries_.size())];
}

void ModelLog::note_sample(const LogTime& time, const plugin::ArmTruth& truth) noexcept {
  Entry& entry = next();
  entry.time = time;
  entry.is_sample = true;
  entry.truth = truth;
}

void ModelLog::note_bytes(const LogTime& time, Direction direction,
                          std::span<const std::uint8_t> bytes) noexcept {
  Entry& entry = next();
  entry.time = time;
  entry.is_sample = false;
  entry.direction = direction;
  entry.size = std::min(bytes.size(), entry.bytes.size());
  std::copy_n(bytes.begin(), entry.size, entry.bytes.begin());
}

std::uint64_t ModelLog::oldest() const noexcept {
  return noted_ - std::min<std::uint64_t>(noted_, entries_.size());
}

const ModelLog::Entry& ModelLog::at(std::uint64_t number) const noexcept {
  return entries_[static_cast<std::size_t>(number % entries_.size())];
}

ModelLog::Cursor ModelLog::since(MonotonicTime from) const noexcept {
  std::uint64_t first = noted_;
  while (first > oldest() && at(first - 1).time.model >= from) --first;
  return {first, noted_};
}

// From the newest back, so that it goes through no more than was asked for, and once.
ModelLog::Felt ModelLog::felt(MonotonicTime from, double above_newton) const noexcept {
  Felt felt;
  MonotonicTime last{};
  MonotonicTime above{};
  for (std::uint64_t i = noted_; i > oldest() && at(i - 1).time.model >= from; --i) {
    const Entry& entry = at(i - 1);
    if (!entry.is_sample) continue;
    const double force_newton = norm(entry.truth.motor_force);
    felt.first = entry.time.model;
    if (felt.frames++ == 0) {
      last = above = felt.first;
      felt.least_newton = felt.most_newton = force_newton;
    }
    felt.least_newton = std::min(felt.least_newton, force_newton);
    felt.most_newton = std::max(felt.most_newton, force_newton);
    if (!(force_newton > above_newton)) continue;
    felt.longest_below = std::max(felt.longest_below, above - felt.first);
    above = felt.first;
  }
  felt.longest_below = std::max(felt.longest_below, above - felt.first);
  felt.lasted = last - felt.first;
  return felt;
}

std::string ModelLog::lines(Cursor& cursor, std::size_t most) const {
  std::string lines;
  cursor.next = std::max(cursor.next, oldest());
  for (; most > 0 && cursor.next < cursor.end; --most) {
    append_line(lines, at(cursor.next));
    ++cursor.next;
    ++cursor.told;
  }
  return lines;
}

void ModelLog::append_line(std::string& lines, const Entry& entry) {
  lines += R"({"t_s":)";
  append_number(lines, seconds(entry.time.model.since_epoch));
  lines += R"(,"machine_s":)";
  append_number(lines, seconds(entry.time.machine.since_epoch));
  if (entry.is_sample) {
    append_triple(lines, R"(,"tip_m":)", entry.truth.tip);
    append_triple(lines, R"(,"force_newton":)", entry.truth.motor_force);
    append_triple(lines, R"(,"current_a":)", entry.truth.motor_current_a);
    lines += entry.truth.is_amplifier_on ? R"(,"amplifier_on":true})" : R"(,"amplifier_on":false})";
  } else {
    lines += R"(,")";
    lines += kDirections[static_cast<std::size_t>(entry.direction)];
    lines += R"(":")";
    append_hex(lines, {entry.bytes.data(), entry.size});
    lines += R"("})";
  }
  lines += '\n';
}

}  // namespace thimble::sim
