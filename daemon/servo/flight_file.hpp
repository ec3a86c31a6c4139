#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/servo/servo_frame.hpp"
#include "hal/device/fault.hpp"

namespace thimble::servo {

struct FlightHeader {
  std::string arm;
  std::string device;
  Fault fault{};
  std::uint64_t without_room{0};  // later stops that came too fast to be recorded
};

// A recording as text: comment lines with the cause in words, then one CSV row per tick,
// SI units in the column names. Pure.
[[nodiscard]] std::string format_flight(const FlightHeader& header,
                                        const std::vector<ServoFrame>& frames);

}  // namespace thimble::servo
