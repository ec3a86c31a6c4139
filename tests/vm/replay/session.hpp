#pragma once

#include <cstddef>
#include <string>

#include "hal/base/result.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/vm/replay/stepped_bus.hpp"
#include "tests/vm/replay/tape.hpp"

namespace thimble::replay {

// Which arm, and how a session has it.
struct Arm {
  std::string model;       // "sim:" model that a tape is recorded of
  std::string words;       // of [[arm]], beside its device and its world
  double rate_hz{0};       // so many reports a second of a session's time
  std::size_t reports{0};  // on the tape
  std::size_t ticks{0};    // that are played: there are reports for all
};
// NotFound: "phantom" or "falcon".
[[nodiscard]] Result<Arm> find_arm(const std::string& name);

// A simulated person takes the arm to where it is calibrated, explores the box of the thesis and
// pushes on its walls, in virtual time: what the arm's device said.
[[nodiscard]] Result<Tape> record(const Arm& arm);

// A session on `buses` and `clock`, which nobody else runs, as the daemon would make it of a
// configuration that names the device. Returns a line for each tick: its number, the servo's state,
// the bits of the force that it sent, and the bytes in which the driver put it.
[[nodiscard]] Result<std::string> play(const Arm& arm, const std::string& device,
                                       bus::BusEnumerator& buses, sim::VirtualClock& clock,
                                       Pace pace);

}  // namespace thimble::replay
