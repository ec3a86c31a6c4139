#pragma once

#include <gpiod.h>

#include <memory>

namespace thimble::linux {

struct CloseGpiodChip {
  void operator()(gpiod_chip* chip) const noexcept { gpiod_chip_close(chip); }
};
// Of libgpiod 1. Closing it releases its lines.
// Thread: one at a time. Not RT: each call, the closing too, may be a transfer that lasts seconds.
// Ownership: of the chip and all its lines. Errors: nullptr where it could not be opened.
using GpiodChip = std::unique_ptr<gpiod_chip, CloseGpiodChip>;

}  // namespace thimble::linux
