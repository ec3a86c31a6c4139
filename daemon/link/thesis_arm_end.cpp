#include "daemon/link/thesis_arm_end.hpp"

#include <algorithm>

#include "daemon/link/earliest.hpp"

namespace thimble::link {

ThesisArmEnd::ThesisArmEnd(const Settings& settings)
    : mode_(settings.mode),
      gate_(SendMode::LockStep),
      outgoing_(settings.impairment, 0),
      incoming_(settings.impairment, 1) {}

bool ThesisArmEnd::poll(MonotonicTime now, ThesisRequest& out) {
  judge_silence(now);
  send_pending(now);
  return outgoing_.pop_due(now, out);
}

bool ThesisArmEnd::is_streaming() const noexcept {
  return mode_ == SendMode::Streamed && accepted_at_.has_value();
}

void ThesisArmEnd::send_pending(MonotonicTime now) {
  if (!pending_ || !(is_streaming() || gate_.may_send(now))) return;
  const Decoded<ThesisRequest> request = encode_thesis_request(pending_->hand);
  pending_.reset();
  if (!request) {
    counters_.reject(request.error());
    return;
  }
  if (is_streaming()) {
    outstanding_.expire(now);
  } else {
    outstanding_.drop_all();  // overdue, or the gate were closed
    gate_.on_sent(now, round_trip_.smoothed());
  }
  outstanding_.on_sent(now);
  ++counters_.sent;
  outgoing_.push(now, *request);
}

std::optional<RejectReason> ThesisArmEnd::on_datagram(std::span<const std::byte> bytes,
                                                      MonotonicTime now) {
  ++counters_.received;
  const Decoded<coupling::PlaneList> planes = decode_thesis_reply(bytes);
  if (!planes) {
    counters_.reject(planes.error());
    return planes.error();
  }
  ThesisReply reply{};
  std::copy(bytes.begin(), bytes.end(), reply.begin());
  incoming_.push(now, reply);
  return std::nullopt;
}

bool ThesisArmEnd::take_reply(MonotonicTime now, coupling::ConstraintSet& out) {
  judge_silence(now);
  for (ThesisReply reply; incoming_.pop_due(now, reply);) {
    const Decoded<coupling::PlaneList> planes = decode_thesis_reply(reply);
    if (!planes || !accept(now)) continue;
    out = {.sequence = last_reply_, .session = session_, .planes = *planes};
    return true;
  }
  return false;
}

bool ThesisArmEnd::accept(MonotonicTime now) {
  const bool is_ambiguous = gate_.is_ambiguous();
  const std::optional<Duration> age = outstanding_.on_reply(now);
  if (!age && !is_ambiguous) {  // nothing asked for it: a copy, or far too late
    ++counters_.stale;
    return false;
  }
  if (age && !is_ambiguous) round_trip_.note(*age);
  gate_.on_reply(now);
  if (!accepted_at_) begin_session(is_ambiguous);
  accepted_at_ = now;
  ++last_reply_;
  ++counters_.accepted;
  return true;
}

void ThesisArmEnd::begin_session(bool is_ambiguous) noexcept {
  ++session_;
  ++counters_.sessions_opened;
  last_reply_ = 0;
  if (is_ambiguous) outstanding_.forget();  // its age taught the wrong round trip
  if (mode_ == SendMode::Streamed) gate_.on_answered();
}

void ThesisArmEnd::judge_silence(MonotonicTime now) noexcept {
  if (!accepted_at_ || now < *accepted_at_ + kSilence) return;
  accepted_at_.reset();
  round_trip_.reset();
  outstanding_.forget();
  if (mode_ == SendMode::Streamed) gate_.on_answered();  // ask at once
  ++counters_.sessions_released;
}

std::optional<MonotonicTime> ThesisArmEnd::next_due() const {
  std::optional<MonotonicTime> due = outgoing_.next_due();
  take_earlier(due, incoming_.next_due());
  if (pending_ && !is_streaming()) take_earlier(due, gate_.deadline());
  if (accepted_at_) take_earlier(due, *accepted_at_ + kSilence);
  return due;
}

coupling::LinkQuality ThesisArmEnd::quality() const noexcept {
  return {.is_up = accepted_at_.has_value(),
          .round_trip = round_trip_.smoothed(),
          .jitter = round_trip_.deviation()};
}

LinkStatus ThesisArmEnd::status() const {
  LinkStatus status;
  status.is_up = accepted_at_.has_value();
  status.round_trip = round_trip_.smoothed();
  status.jitter = round_trip_.deviation();
  status.counters = counters_;
  status.counters.lost = outstanding_.lost();
  status.counters.timed_out = gate_.timed_out();
  status.counters.injected = sum(outgoing_.counters(), incoming_.counters());
  return status;
}

}  // namespace thimble::link
