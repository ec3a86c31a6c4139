#include "daemon/link/deadband.hpp"

#include <algorithm>

namespace thimble::link {

bool Deadband::may_skip(const coupling::HandSample& sample, MonotonicTime now,
                        Duration answer_after) const noexcept {
  if (position_m_ <= 0 || !last_ || now - last_sent_at_ >= kMaxGap) return false;
  const bool says_more = sample.buttons != last_->buttons || sample.restart != last_->restart ||
                         sample.tool != last_->tool || sample.presses != last_->presses ||
                         sample.actions != last_->actions;
  if (says_more || !(norm(sample.hand - last_->hand) <= position_m_)) return false;
  const double told_m_per_s = norm(last_->velocity);
  const double change_m_per_s = norm(sample.velocity - last_->velocity);
  if (!(change_m_per_s <= std::max(kStill_m_per_s, kWeber_ratio * told_m_per_s))) return false;
  const bool is_overdue =
      now - last_sent_at_ > answer_after && (!answered_ || answered_->sent_at < last_sent_at_);
  return !is_overdue || (answered_ && norm(sample.hand - answered_->hand) <= position_m_);
}

void Deadband::on_sent(const coupling::HandSample& sample, MonotonicTime now) noexcept {
  last_ = sample;
  last_sent_at_ = now;
}

void Deadband::on_answered(Position3 hand, MonotonicTime sent_at) noexcept {
  if (answered_ && sent_at <= answered_->sent_at) return;
  answered_ = State{hand, sent_at};
}

}  // namespace thimble::link
