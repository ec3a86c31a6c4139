#pragma once

#include <algorithm>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::falcon {

// One request, one reply: says when the next request may leave.
//
// The arm never talks unasked, and what it does with two requests at once nobody knows. So the next
// leaves when the last is answered; and when an answer takes longer than kPatience, without it.
// As after a lost reply, and nobody can tell which it was: behind an arm that answers later than
// that, one request leaves every kPatience, and as many are under way as fit into its answer, five
// at 16 ms (decision 0386). After the first of the late ones nothing leaves until another came or
// kPatience passed, so that the exchange is in step again.
//
// Thread: one. RT: all THIMBLE_RT. A value. Errors: none. Times are its owner's: of the packets
// that arrive, and of a clock where none does.
class ExchangePacer {
 public:
  THIMBLE_RT void restart() noexcept { *this = ExchangePacer(); }
  [[nodiscard]] bool may_send(MonotonicTime now) const noexcept {
    return under_way_ == 0 || now - last_event_ >= kPatience;
  }
  THIMBLE_RT void on_sent(MonotonicTime now) noexcept {
    if (!is_asking_) asking_since_ = now;
    is_asking_ = true;
    const bool is_late = under_way_ > 0 && !is_answered_;
    under_way_ = is_late ? 2 : 1;
    is_answered_ = false;
    last_event_ = now;
  }
  THIMBLE_RT void on_reply(MonotonicTime now) noexcept {
    under_way_ = std::max(0, under_way_ - 1);
    is_answered_ = true;
    is_asking_ = false;
    last_event_ = now;
  }
  // So long nothing was answered of what was asked that nobody is there any more.
  [[nodiscard]] bool is_deserted(MonotonicTime now) const noexcept {
    return is_asking_ && now - asking_since_ >= kDeserted;
  }

  // Ours. An answer takes 1.3 ms and up to a tick to be seen; after 20 ms without one the servo
  // stops the arm, so that a reply may be lost three times in a row.
  static constexpr Duration kPatience = std::chrono::milliseconds(4);
  // Ours: far beyond every fault of the servo, and a person does not notice.
  static constexpr Duration kDeserted = std::chrono::milliseconds(500);

 private:
  int under_way_{0};
  bool is_answered_{true};  // something came since the last request
  bool is_asking_{false};
  MonotonicTime last_event_{};
  MonotonicTime asking_since_{};
};

}  // namespace thimble::falcon
