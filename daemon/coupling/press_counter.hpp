#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "daemon/coupling/messages.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Counts the presses of an arm's buttons where every report of it is seen, and writes them into its
// samples, of which any may be lost or replaced on their way.
//
// Thread: one servo thread. RT: THIMBLE_RT. Errors: none.
class PressCounter {
 public:
  // `buttons` of the newest report, a bit each; what was not pressed before is pressed now.
  THIMBLE_RT void count(std::uint32_t buttons, HandSample& sample) noexcept {
    const std::uint32_t pressed = buttons & ~std::exchange(buttons_, buttons);
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      if ((pressed >> i & 1U) == 0) continue;
      ++counts_[i];
      has_any_ = true;
    }
    sample.presses = counts_;
    sample.has_presses = has_any_;
  }

 private:
  std::uint32_t buttons_{0};
  PressCounts counts_{};
  bool has_any_{false};
};

}  // namespace thimble::coupling
