#include "daemon/link/thimble_session.hpp"

#include <utility>

namespace thimble::link {
namespace {

Seal session_seal(const std::optional<LinkKey>& key, Towards towards,
                  const ThimbleSession::Origin& origin) noexcept {
  if (!key) return {};
  return Seal::of_session(*key, towards, origin.arm_nonce, origin.world_nonce, origin.token);
}

}  // namespace

ThimbleSession::ThimbleSession(const Origin& origin, const std::optional<LinkKey>& key,
                               std::unique_ptr<coupling::WorldCoupling> half, MonotonicTime now)
    : origin_(origin),
      from_arm_(session_seal(key, Towards::World, origin)),
      to_arm_(session_seal(key, Towards::Arm, origin)),
      half_(std::move(half)),
      session_(*half_),
      heard_at_(now),
      inside_at_(now) {}

template <class Message>
bool ThimbleSession::send(ThimbleKind kind, const Message& message, ThimbleDatagram& out) {
  const ThimbleHeader header{.kind = kind, .session = origin_.token, .sequence = sequence_ + 1};
  // Only a handshake needs what is random.
  const Decoded<void> packed = to_arm_.pack(header, message, RandomBytes(), out);
  if (!packed) {
    counters_.reject(packed.error());
    return false;
  }
  ++sequence_;
  ++counters_.sent;
  return true;
}

bool ThimbleSession::welcome(const ThimbleWelcome& welcome, ThimbleDatagram& out) {
  ThimbleWelcome message = welcome;
  message.epoch = half_->cells_epoch();
  return send(ThimbleKind::Welcome, message, out);
}

bool ThimbleSession::serve(const ThimbleHeader& header, std::span<const std::byte> datagram,
                           MonotonicTime now, ThimbleDatagram& out) {
  ++counters_.received;
  std::array<std::byte, kMaxThimbleContent> room;
  ThimbleSample message;
  const auto content = from_arm_.open(header, datagram, room);
  const Decoded<void> read = content ? decode(*content, message) : tl::unexpected(content.error());
  if (!read) {
    counters_.reject(read.error());
    return false;
  }
  if (!is_newest(header.sequence)) return false;
  has_begun_ = true;
  heard(message.timing, now);
  const ThimbleTiming timing{.sent_at = now, .echo = message.timing.sent_at, .echoed_at = now};
  if (!is_in_world(message.sample, now)) {
    return send(ThimbleKind::Idle, ThimbleIdle{timing, header.sequence}, out);
  }
  inside_at_ = now;
  ++counters_.accepted;
  ThimbleConstraints reply{.timing = timing, .request = header.sequence};
  reply.set = session_.answer(message.sample, now);
  // The same set again: the world has nothing to say, and is to look as silent as it is.
  const Told told{reply.set.session, reply.set.sequence};
  if (told.sequence == 0 || std::exchange(told_, told) == told) {
    return send(ThimbleKind::Idle, ThimbleIdle{timing, header.sequence}, out);
  }
  return send(ThimbleKind::Constraints, reply, out);
}

bool ThimbleSession::is_newest(std::uint64_t sequence) noexcept {
  switch (arrived_.note(sequence).verdict) {
    case SequenceWindow::Verdict::Newest:
      return true;
    case SequenceWindow::Verdict::Duplicate:
      ++counters_.duplicated;
      break;
    case SequenceWindow::Verdict::Overtaken:
      ++counters_.reordered;
      break;
  }
  ++counters_.stale;
  return false;
}

void ThimbleSession::heard(const ThimbleTiming& timing, MonotonicTime now) noexcept {
  heard_at_ = now;
  if (timing.echo == MonotonicTime() || timing.echoed_at == MonotonicTime()) return;
  round_trip_.note((now - timing.echo) - (timing.sent_at - timing.echoed_at));
  clocks_.note({timing.echo, timing.echoed_at, timing.sent_at, now});
}

// An arm half that was reset begins anew where the hand is.
bool ThimbleSession::is_in_world(const coupling::HandSample& sample, MonotonicTime now) {
  if (sample.restart != restart_) session_.close();
  restart_ = sample.restart;
  if (session_.is_open()) return true;
  if (retry_at_ && now < *retry_at_) return false;
  retry_at_.reset();
  const bool is_open = session_.open(sample, now, counters_);
  // To look for a place may take a world some milliseconds: who starts again and again waits, too.
  retry_at_ = now + WorldSession::kRetry;
  return is_open;
}

LinkStatus ThimbleSession::status() const {
  LinkStatus status;
  status.peer = to_string(origin_.peer);
  status.last_error = session_.last_error();
  status.scheme = origin_.scheme.view();
  status.is_up = session_.is_open();
  status.round_trip = round_trip_.smoothed();
  status.jitter = round_trip_.deviation();
  if (clocks_.is_known()) status.clocks = clocks_.status();
  status.counters = counters_;
  return status;
}

}  // namespace thimble::link
