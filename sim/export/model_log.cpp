#include "sim/export/model_log.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

namespace thimble::sim {
namespace {

constexpr std::array<std::string_view, 3> kDirections{"out", "in", "request"};

// Enough digits for 0.1 um, 0.1 mN and 0.1 us.
template <class Three>
void append_triple(std::string& text, const char* name, const Three& value) {
  std::array<char, 128> buffer{};
  const int size = std::snprintf(buffer.data(), buffer.size(), R"(,"%s":[%.7f,%.7f,%.7f])", name,
                                 value[0], value[1], value[2]);
  text.append(buffer.data(), static_cast<std::size_t>(std::max(size, 0)));
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

std::string ModelLog::lines_since(MonotonicTime from) const {
  std::string lines;
  const std::uint64_t kept = std::min<std::uint64_t>(noted_, entries_.size());
  for (std::uint64_t i = noted_ - kept; i < noted_; ++i) {
    const Entry& entry = entries_[static_cast<std::size_t>(i % entries_.size())];
    if (entry.time.model >= from) append_line(lines, entry);
  }
  return lines;
}

void ModelLog::append_line(std::string& lines, const Entry& entry) {
  std::array<char, 96> buffer{};
  const int size =
      std::snprintf(buffer.data(), buffer.size(), R"({"t_s":%.7f,"machine_s":%.7f)",
                    seconds(entry.time.model.since_epoch), seconds(entry.time.machine.since_epoch));
  lines.append(buffer.data(), static_cast<std::size_t>(std::max(size, 0)));
  if (entry.is_sample) {
    append_triple(lines, "tip_m", entry.truth.tip);
    append_triple(lines, "force_newton", entry.truth.motor_force);
    append_triple(lines, "current_a", entry.truth.motor_current_a);
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
