#pragma once

#include "hal/linux/descriptor.hpp"

namespace thimble::linux {

// An opened device, for another process. Ownership: the caller's.
struct SharedDevice {
  Descriptor node;    // may be written
  Descriptor hiddev;  // of a HID device that takes plain bytes there, too (hiddev.hpp); else none
  // hidraw wants the number of a report before it, and 0 where reports have none; a report that has
  // one begins with it already.
  bool takes_leading_zero{false};
};

}  // namespace thimble::linux
