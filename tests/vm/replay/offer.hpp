#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/result.hpp"
#include "tests/vm/replay/tape.hpp"

namespace thimble::replay {

// Offers the device of a tape to this machine's kernel until a signal ends it: by USB/IP at that
// port of the loopback, or through uhid. Errors: as UhidPlug and UsbipPlug.
Result<void> offer(const Tape& tape, std::optional<std::uint16_t> usbip_port);

}  // namespace thimble::replay
