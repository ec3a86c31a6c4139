#pragma once

#include "hal/linux/descriptor.hpp"

namespace thimble::linux {

// An opened device, for another process. Ownership: the caller's.
struct SharedDevice {
  Descriptor node;    // may be written
  Descriptor hiddev;  // of a HID device that takes plain bytes there, too (hiddev.hpp); else none
};

}  // namespace thimble::linux
