#pragma once

#include <cstdint>
#include <optional>

#include "daemon/coupling/messages.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// Says which samples of a stream may stay unsent because the other side knows as much without them
// (Hinterseer and Steinbach, docs/references.md; teleop.md): the hand is within `position_m` of
// what was sent last, its velocity within kWeber_ratio of that speed, or within kStill_m_per_s.
// Buttons, presses, actions, a restart and another tool are sent at once, and something each
// kMaxGap, so that no constraint grows old for it.
//
// It does not trust the network: what was sent last counts only until its answer is overdue. Then
// the state of the newest sample that was answered is what the other side holds, and a hand that
// is not near that is sent again. So the other side is never wrong by more than `position_m`, and
// what the hand moves in a round trip, or in kMaxGap.
//
// Thread: one. RT: allocation-free. Errors: none.
class Deadband {
 public:
  static constexpr Duration kMaxGap =
      std::chrono::milliseconds(5);            // a quarter of where frames freeze
  static constexpr double kWeber_ratio = 0.1;  // 5 to 10 % of force are told apart (teleop.md)
  static constexpr double kStill_m_per_s =
      0.02;  // ours: an encoder's step of 0.03 mm in 1 ms, filtered

  // 0: everything is sent.
  explicit Deadband(double position_m) noexcept : position_m_(position_m) {}

  // `answer_after`: how long an answer takes, and what it may be late.
  [[nodiscard]] bool may_skip(const coupling::HandSample& sample, MonotonicTime now,
                              Duration answer_after) const noexcept;
  void on_sent(const coupling::HandSample& sample, MonotonicTime now) noexcept;
  // The sample that was sent `sent_at` was answered; its hand.
  void on_answered(Position3 hand, MonotonicTime sent_at) noexcept;
  void reset() noexcept { last_.reset(), answered_.reset(); }

 private:
  struct State {
    Position3 hand{};
    MonotonicTime sent_at{};
  };

  double position_m_;
  std::optional<coupling::HandSample> last_;
  MonotonicTime last_sent_at_{};
  std::optional<State> answered_;
};

}  // namespace thimble::link
