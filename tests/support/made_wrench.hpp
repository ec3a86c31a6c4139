#pragma once

#include "hal/device/limited_wrench.hpp"

// For programs that link no limiter: here the friend of LimitedWrench only makes wrenches.
namespace thimble::servo {
class WrenchLimiter {
 public:
  static LimitedWrench make(Force3 force) { return LimitedWrench(force); }
};
}  // namespace thimble::servo
