#pragma once

#include "hal/base/result.hpp"
#include "tests/vm/offer/offer_model.hpp"
#include "tests/vm/replay/tape.hpp"

namespace thimble::replay {

// Offers the device of a tape to this machine's kernel until a signal ends it. `way`: one that is a
// HID arm. Errors: as offer_model().
Result<void> offer(const Tape& tape, test::HidWay way);

}  // namespace thimble::replay
