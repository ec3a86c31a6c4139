#pragma once

#include <cstdint>

namespace thimble::safety {

// The latch of an emergency stop, as machine control has it: stopped from the start, stopped at
// once by anything unhealthy, and let go only by a person's request that comes while all is
// healthy. A request that comes too early is spent: nothing resumes because a button was released.
//
// Thread: one. Pure.
class EstopLatch {
 public:
  // Once per look at the inputs.
  void judge(bool is_healthy) noexcept {
    is_healthy_ = is_healthy;
    if (!is_healthy) is_stopped_ = true;
  }
  // A person asks. True when it is not stopped now.
  bool reset() noexcept {
    if (is_healthy_) is_stopped_ = false;
    return !is_stopped_;
  }
  [[nodiscard]] bool is_stopped() const noexcept { return is_stopped_; }

 private:
  bool is_healthy_{false};
  bool is_stopped_{true};
};

}  // namespace thimble::safety
