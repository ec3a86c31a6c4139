#include "daemon/link/in_process_link.hpp"

#include <utility>

#include "daemon/link/earliest.hpp"

namespace thimble::link {

InProcessLink::InProcessLink(const Settings& settings, coupling::WorldCoupling& world,
                             rt::WakeSignal* wake)
    : is_lock_step_(settings.mode == SendMode::LockStep),
      hears_actions_(settings.hears_actions),
      mailbox_(wake),
      session_(world),
      gate_(settings.mode),
      to_world_(settings.impairment, 0),
      to_arm_(settings.impairment, 1) {}

std::optional<MonotonicTime> InProcessLink::pump(MonotonicTime now) {
  session_.release_if_silent(now, counters_);
  take_sample();
  accept_replies(now);  // may open the gate for the pending sample
  send_pending(now);
  serve_world(now);
  accept_replies(now);
  send_pending(now);
  count_unanswered(now);
  if (accepted_at_ && now >= *accepted_at_ + kSilence) {
    accepted_at_.reset();
    round_trip_.reset();
  }
  mailbox_.publish({.is_up = accepted_at_.has_value(),
                    .round_trip = round_trip_.smoothed(),
                    .jitter = round_trip_.deviation()});
  return next_due();
}

void InProcessLink::take_sample() {
  coupling::HandSample sample;
  if (!mailbox_.take(sample)) return;
  if (!is_finite(sample.hand) || !is_finite(sample.velocity)) {
    counters_.reject(RejectReason::NonFinite);
    return;
  }
  restart_ = sample.restart;
  pending_ = sample;
}

void InProcessLink::send_pending(MonotonicTime now) {
  if (!pending_ || !gate_.may_send(now)) return;
  gate_.on_sent(now, round_trip_.smoothed());
  ++counters_.sent;
  to_world_.push(now, {{++last_number_, now}, *pending_});
  pending_.reset();
}

void InProcessLink::serve_world(MonotonicTime now) {
  for (CarriedSample arrived; to_world_.pop_due(now, arrived);) {
    const bool is_other = arrived.sample.restart != served_restart_;
    const bool is_newest = arrived.carried.number > served_;
    if (is_other && served_ > 0 && !is_newest) continue;  // overtaken by the restart
    if (is_newest) served_ = arrived.carried.number;
    if (is_other) session_.close();  // its ghost stands where the hand was before
    served_restart_ = arrived.sample.restart;
    if (!session_.is_open() && !open_session(arrived.sample, now)) continue;
    CarriedReply reply{arrived.carried, arrived.sample.restart,
                       session_.answer(arrived.sample, now)};
    // The same set again: the world has nothing to say, and is to look as silent as it is.
    const Told told{reply.reply.session, reply.reply.sequence};
    if (told.sequence == 0 || std::exchange(told_, told) == told) continue;
    reply.reply.answers = arrived.sample.sequence;
    reply.reply.sampled_at = arrived.sample.sampled_at;
    to_arm_.push(now, reply);
  }
}

bool InProcessLink::open_session(const coupling::HandSample& first, MonotonicTime now) {
  if (retry_at_ && now < *retry_at_) return false;
  retry_at_.reset();
  if (session_.open(first, now, counters_)) return true;
  retry_at_ = now + WorldSession::kRetry;
  return false;
}

void InProcessLink::accept_replies(MonotonicTime now) {
  for (CarriedReply arrived; to_arm_.pop_due(now, arrived);) accept(arrived, now);
}

void InProcessLink::accept(const CarriedReply& arrived, MonotonicTime now) {
  ++counters_.received;
  const SequenceWindow::Outcome outcome = arrived_.note(arrived.carried.number);
  if (outcome.verdict == SequenceWindow::Verdict::Duplicate) {
    ++counters_.stale;
    ++counters_.duplicated;
    return;
  }
  if (outcome.verdict == SequenceWindow::Verdict::Overtaken) {
    ++counters_.stale;
    ++counters_.reordered;
    if (counters_.lost > 0) --counters_.lost;  // it was counted when the newer one came
    return;
  }
  const std::uint64_t number = arrived.carried.number;
  if (number > accounted_) {
    counters_.lost += number - accounted_ - 1;
    accounted_ = number;
  } else {
    --counters_.lost;  // it was counted when its time was up
  }
  accepted_at_ = now;
  round_trip_.note(now - arrived.carried.sent_at);
  if (arrived.carried.number == last_number_) {
    gate_.on_answered();
    // What waited was made before this reply is in force (teleop.md 7 row 8): the next one is not.
    if (is_lock_step_) pending_.reset();
  }
  if (arrived.restart != restart_) {  // proves the link, but its ghost is gone
    ++counters_.stale;
    return;
  }
  ++counters_.accepted;
  mailbox_.deliver(arrived.reply);
}

// One mark at a time: a sample is counted one to two kSilence after it left.
void InProcessLink::count_unanswered(MonotonicTime now) noexcept {
  if (overdue_ && now >= overdue_->sent_at + kSilence) {
    if (overdue_->number > accounted_) {
      counters_.lost += overdue_->number - accounted_;
      accounted_ = overdue_->number;
    }
    overdue_.reset();
  }
  if (overdue_ && overdue_->number <= accounted_) overdue_.reset();
  if (!overdue_ && last_number_ > accounted_) overdue_ = Carried{last_number_, now};
}

std::optional<MonotonicTime> InProcessLink::next_due() const {
  std::optional<MonotonicTime> due = to_world_.next_due();
  take_earlier(due, to_arm_.next_due());
  if (pending_) take_earlier(due, gate_.deadline());
  if (session_.is_open()) take_earlier(due, session_.silent_at());
  if (accepted_at_) take_earlier(due, *accepted_at_ + kSilence);
  if (overdue_) take_earlier(due, overdue_->sent_at + kSilence);
  return due;
}

LinkStatus InProcessLink::status() const {
  LinkStatus status;
  status.peer = "in process";
  status.last_error = session_.last_error();
  status.is_up = accepted_at_.has_value();
  status.hears_actions = hears_actions_;
  status.round_trip = round_trip_.smoothed();
  status.jitter = round_trip_.deviation();
  status.counters = counters_;
  status.counters.timed_out = gate_.timed_out();
  status.counters.injected = sum(to_world_.counters(), to_arm_.counters());
  return status;
}

}  // namespace thimble::link
