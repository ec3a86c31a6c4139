#pragma once

#include <gpiod.h>

#include <memory>

namespace thimble::linux {

struct CloseGpiodChip {
  void operator()(gpiod_chip* chip) const noexcept { gpiod_chip_close(chip); }
};
// Of libgpiod 1. Closing it releases its lines.
using GpiodChip = std::unique_ptr<gpiod_chip, CloseGpiodChip>;

}  // namespace thimble::linux
