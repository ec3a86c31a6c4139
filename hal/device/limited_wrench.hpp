#pragma once

#include <type_traits>

#include "hal/base/geometry.hpp"

namespace thimble {

namespace servo {
class WrenchLimiter;
}

// A force that went through the limiter. HapticDevice::write() takes nothing else and only
// servo::WrenchLimiter can make one that is not zero: no path writes around the limiter. Its copy
// is written out so that it is not trivially copyable: std::bit_cast refuses to make one of bytes,
// and the compiler warns of a memcpy() into one.
class LimitedWrench {
 public:
  constexpr LimitedWrench() noexcept = default;  // zero
  constexpr LimitedWrench(const LimitedWrench& other) noexcept : force_(other.force_) {}
  constexpr LimitedWrench& operator=(const LimitedWrench&) noexcept = default;
  [[nodiscard]] static constexpr LimitedWrench zero() noexcept { return {}; }
  // N, at the tip, base frame of the arm.
  [[nodiscard]] constexpr Force3 force() const noexcept { return force_; }

 private:
  friend class servo::WrenchLimiter;
  explicit constexpr LimitedWrench(Force3 force) noexcept : force_(force) {}
  Force3 force_{};
};
static_assert(!std::is_trivially_copyable_v<LimitedWrench>, "bytes can be made into a force");

}  // namespace thimble
