#pragma once

#include "hal/base/time.hpp"

namespace thimble {

// For who is woken by something outside that may chatter without end, such as a line with a loose
// contact, and must not take a processor for it: how long to pause before the next wake is heard.
//
// Thread: one. Pure but for what it counts. RT: yes.
class BurstPause {
 public:
  // Both ours: the first edge of a press is heard at once; a storm is heard 4,000 times a second,
  // and a stop in the middle of one comes half a millisecond late at most, of the 2 ms it has.
  static constexpr int kMost = 2;
  static constexpr Duration kWindow = std::chrono::microseconds(500);

  // Of a wake at `now`; zero: none.
  [[nodiscard]] Duration after_wake(MonotonicTime now) noexcept {
    if (count_ == 0 || now - begun_ >= kWindow) {
      begun_ = now;
      count_ = 0;
    }
    return ++count_ < kMost ? Duration::zero() : begun_ + kWindow - now;
  }

 private:
  MonotonicTime begun_{};
  int count_{0};
};

}  // namespace thimble
