#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"

namespace thimble::flight {

// Two seconds at 8 kHz are 16,000 rows of at most 640 bytes.
inline constexpr std::size_t kMaxFileBytes = std::size_t{16} << 20;

// One tick of a flight recording, as daemon/servo/flight_file.cpp wrote it. SI, the arm's base
// frame. What the file has beyond it is not read. Numbers may be NaN: a broken force is a cause.
struct Sample {
  std::uint64_t tick{0};
  double now_s{0};
  double lateness_s{0};
  double sample_age_s{0};
  std::string state;
  std::string read;   // what came of the exchange with the device
  std::string fault;  // latched in this tick; "none"
  Velocity3 velocity{};
  Displacement3 offset{};
  Force3 wish{};   // before the limiter
  Force3 force{};  // sent
  bool is_in_contact{false};
  bool is_limited{false};
  bool is_stale{false};
};

struct Recording {
  std::string arm;
  std::string device;
  std::string cause;            // a fault's short name and its tick
  std::string meaning;          // of the cause, a sentence
  std::vector<Sample> samples;  // never empty; the oldest first
};

// Total: any text gives a recording or an error. Columns are known by name, so that a version with
// more of them is still read.
// Errors: Malformed or TooLarge, with the line and what was expected.
[[nodiscard]] Result<Recording> parse_recording(std::string_view text);

}  // namespace thimble::flight
