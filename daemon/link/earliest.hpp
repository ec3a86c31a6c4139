#pragma once

#include <algorithm>
#include <optional>

#include "hal/base/time.hpp"

namespace thimble::link {

// Lowers `earliest` to `other` where that is sooner; none is never. Pure; thread: any.
inline void take_earlier(std::optional<MonotonicTime>& earliest,
                         std::optional<MonotonicTime> other) noexcept {
  if (!other) return;
  earliest = earliest ? std::min(*earliest, *other) : *other;
}

}  // namespace thimble::link
