#pragma once

#include "hal/base/geometry.hpp"

namespace thimble {

namespace servo {
class WrenchLimiter;
}

// A force that went through the limiter. HapticDevice::write() takes nothing else and only
// servo::WrenchLimiter can make one that is not zero: no path writes around the limiter.
class LimitedWrench {
 public:
  constexpr LimitedWrench() noexcept = default;  // zero
  [[nodiscard]] static constexpr LimitedWrench zero() noexcept { return {}; }
  // N, at the tip, base frame of the arm.
  [[nodiscard]] constexpr Force3 force() const noexcept { return force_; }

 private:
  friend class servo::WrenchLimiter;
  explicit constexpr LimitedWrench(Force3 force) noexcept : force_(force) {}
  Force3 force_{};
};

}  // namespace thimble
