#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "daemon/servo/flight_file.hpp"

namespace thimble::flight {

// 200 ticks of 1 ms, as the servo's own writer writes them: the force grows by 10 mN a tick, and
// tick 180 latches overspeed and sends nothing any more.
inline std::string written_recording() {
  std::vector<servo::ServoFrame> frames(200);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    servo::ServoFrame& frame = frames[i];
    frame.tick = 1000 + i;
    frame.now = {std::chrono::seconds(5) + std::chrono::milliseconds(i)};
    frame.lateness = std::chrono::microseconds(20);
    frame.state = OperatingState::Active;
    frame.read_status = IoStatus::Ok;
    frame.velocity = {0.3, 0, 0.4};
    frame.offset = {0, 0.002, 0};
    frame.wish = {0.01 * static_cast<double>(i), 0, 0};
    frame.force = frame.wish;
    frame.is_in_contact = i % 2 == 0;
    if (i < 180) continue;
    frame.state = OperatingState::Fault;
    frame.fault = FaultCode::Overspeed;
    frame.force = {};
  }
  return servo::format_flight({.arm = "right",
                               .device = "sim:phantom-vintage",
                               .fault = {.code = FaultCode::Overspeed, .tick = 1180}},
                              frames);
}

}  // namespace thimble::flight
