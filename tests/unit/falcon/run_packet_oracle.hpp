#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "drivers/falcon/falcon_codec.hpp"

namespace thimble::falcon::test {

using Bytes = std::vector<std::uint8_t>;

// The packet as a person would write it down: text, and numbers by division.
inline std::string number_text(int value) {
  int rest = value < 0 ? value + 65536 : value;
  std::string text;
  for (int i = 0; i < 4; ++i) {
    text += "ABCDEFGHIJKLMNOP"[rest % 16];
    rest /= 16;
  }
  return text;
}

inline Bytes report_bytes(const std::array<std::int16_t, 3>& counts, int flags,
                          std::uint8_t unknown = 'A') {
  std::string text = "<";
  for (const int value : counts) text += number_text(value);
  Bytes bytes(text.begin(), text.end());
  bytes.push_back(static_cast<std::uint8_t>('A' + flags));
  bytes.push_back(unknown);
  bytes.push_back('>');
  return bytes;
}

// Everything at once, with no state: tries each place of the whole stream in turn.
inline std::vector<RunReport> reports_in(const Bytes& stream) {
  std::vector<RunReport> found;
  for (std::size_t at = 0; at + 16 <= stream.size();) {
    bool is_report = stream[at] == '<' && stream[at + 15] == '>';
    for (std::size_t i = 1; i < 13; ++i) {
      is_report = is_report && stream[at + i] >= 'A' && stream[at + i] <= 'P';
    }
    const int flags = stream[at + 13] - 'A';
    if (!is_report || flags < 0 || flags > 127) {
      ++at;
      continue;
    }
    RunReport report;
    for (std::size_t k = 0; k < 3; ++k) {
      int value = 0;
      for (std::size_t i = 4; i > 0; --i) value = 16 * value + stream[at + 4 * k + i] - 'A';
      report.encoder_counts[k] = static_cast<std::int16_t>(value < 32768 ? value : value - 65536);
    }
    report.buttons = static_cast<std::uint8_t>(flags % 16);
    report.homed = static_cast<std::uint8_t>(flags - flags % 16);
    found.push_back(report);
    at += 16;
  }
  return found;
}

inline int between(std::mt19937& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

inline Bytes any_report(std::mt19937& random) {
  std::array<std::int16_t, 3> counts{};
  for (std::int16_t& value : counts) {
    value = static_cast<std::int16_t>(between(random, -32768, 32767));
  }
  return report_bytes(counts, between(random, 0, 127),
                      static_cast<std::uint8_t>(between(random, 0, 255)));
}

}  // namespace thimble::falcon::test
