#include "daemon/link/thesis_world_end.hpp"

#include "daemon/link/earliest.hpp"

namespace thimble::link {

ThesisWorldEnd::ThesisWorldEnd(const Settings& settings, coupling::WorldCoupling& world)
    : pinned_peer_(settings.pinned_peer),
      session_(world),
      incoming_(settings.impairment, 0),
      outgoing_(settings.impairment, 1) {}

std::optional<RejectReason> ThesisWorldEnd::on_datagram(const Endpoint& from,
                                                        std::span<const std::byte> bytes,
                                                        MonotonicTime now) {
  ++counters_.received;
  if (pinned_peer_ && !pinned_peer_->has_same_address(from)) {
    counters_.reject(RejectReason::WrongPeer);
    return RejectReason::WrongPeer;
  }
  const Decoded<Position3> hand = decode_thesis_request(bytes);
  if (!hand) {
    counters_.reject(hand.error());
    return hand.error();
  }
  incoming_.push(now, {from, *hand});
  return std::nullopt;
}

bool ThesisWorldEnd::poll(MonotonicTime now, Reply& out) {
  session_.release_if_silent(now, counters_);
  serve_waiting(now);
  for (Request request; incoming_.pop_due(now, request);) serve(request, now);
  if (!outgoing_.pop_due(now, out)) return false;
  ++counters_.sent;
  return true;
}

void ThesisWorldEnd::serve(const Request& request, MonotonicTime now) {
  if (session_.is_open() && !(peer_ == request.from)) {
    counters_.reject(RejectReason::WrongPeer);
    return keep_waiting(request, now);
  }
  const coupling::HandSample sample{
      .sequence = ++last_sequence_, .sampled_at = now, .hand = request.hand};
  if (!session_.is_open()) {
    if (!session_.open(sample, now, counters_)) return keep_waiting(request, now + kRetry);
    peer_ = request.from;
  }
  ++counters_.accepted;
  const coupling::ConstraintSet answer = session_.answer(sample, now);
  const EncodedReply reply = encode_thesis_reply(sample.hand, answer.planes);
  counters_.unencodable_planes += reply.unencodable;
  outgoing_.push(now, {request.from, reply.bytes});
}

void ThesisWorldEnd::serve_waiting(MonotonicTime now) {
  if (!waiting_ || session_.is_open() || now < retry_at_) return;
  const Request request = *waiting_;
  waiting_.reset();
  serve(request, now);
}

void ThesisWorldEnd::keep_waiting(const Request& request, MonotonicTime retry_at) {
  waiting_ = request;
  retry_at_ = retry_at;
}

std::optional<MonotonicTime> ThesisWorldEnd::next_due() const {
  std::optional<MonotonicTime> due = incoming_.next_due();
  take_earlier(due, outgoing_.next_due());
  if (session_.is_open()) {
    take_earlier(due, session_.silent_at());
  } else if (waiting_) {
    take_earlier(due, retry_at_);
  }
  return due;
}

LinkStatus ThesisWorldEnd::status() const {
  LinkStatus status;
  if (session_.is_open()) status.peer = to_string(peer_);
  status.last_error = session_.last_error();
  status.is_up = session_.is_open();
  status.counters = counters_;
  status.counters.injected = sum(incoming_.counters(), outgoing_.counters());
  return status;
}

}  // namespace thimble::link
