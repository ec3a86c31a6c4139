#pragma once

#include "sim/time/trace_hash.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble::test {

// Everything in a frame; times and doubles to their last bit.
inline void add_to(sim::TraceHash& hash, const servo::ServoFrame& frame) {
  hash.add(frame.tick);
  for (const Duration d : {frame.now.since_epoch, frame.lateness, frame.sample_age, frame.dt}) {
    hash.add(d.count());
  }
  const auto add_all = [&hash](const auto&... v) {
    for (std::size_t axis = 0; axis < 3; ++axis) (hash.add(v[axis]), ...);
  };
  add_all(frame.tip, frame.velocity, frame.offset, frame.wish, frame.force);
  hash.add(frame.gain);
  hash.add(frame.generated_energy_j);
  for (const auto code :
       {static_cast<unsigned>(frame.state), static_cast<unsigned>(frame.calibration),
        static_cast<unsigned>(frame.read_status), static_cast<unsigned>(frame.write_status),
        static_cast<unsigned>(frame.fault), frame.buttons, frame.contacts}) {
    hash.add(code);
  }
  for (const bool flag :
       {frame.is_in_contact, frame.is_limited, frame.is_stale, frame.is_frozen, frame.is_fading}) {
    hash.add(static_cast<std::uint8_t>(flag));
  }
}

}  // namespace thimble::test
