#include "daemon/link/thimble_world_end.hpp"

#include <algorithm>
#include <utility>

#include "daemon/link/earliest.hpp"

namespace thimble::link {
namespace {

// What arrived was counted when it did.
LinkCounters without_arrivals(LinkCounters counters) noexcept {
  counters.received = 0;
  return counters;
}

}  // namespace

ThimbleWorldEnd::ThimbleWorldEnd(const Settings& settings, MakeHalf make_half, RandomBytes random)
    : settings_(settings),
      make_half_(std::move(make_half)),
      random_(std::move(random)),
      challenges_(random_),
      from_arm_(settings.key ? Seal::of_handshake(*settings.key, Towards::World) : Seal()),
      to_arm_(settings.key ? Seal::of_handshake(*settings.key, Towards::Arm) : Seal()),
      incoming_(settings.impairment, 0),
      outgoing_(settings.impairment, 1) {}

std::optional<RejectReason> ThimbleWorldEnd::on_datagram(const Endpoint& from,
                                                         std::span<const std::byte> bytes,
                                                         MonotonicTime now) {
  ++counters_.received;
  const bool is_pinned = !settings_.pinned_peer || settings_.pinned_peer->has_same_address(from);
  const Decoded<ThimbleHeader> header = decode_header(bytes);
  if (!is_pinned || !header) {
    const RejectReason reason = is_pinned ? header.error() : RejectReason::WrongPeer;
    counters_.reject(reason);
    return reason;
  }
  Arrived arrived{.from = from, .datagram = {}};
  std::copy(bytes.begin(), bytes.end(), arrived.datagram.bytes.begin());
  arrived.datagram.size = bytes.size();
  incoming_.push(now, arrived);
  return std::nullopt;
}

bool ThimbleWorldEnd::poll(MonotonicTime now, Reply& out) {
  release_silent(now);
  for (Arrived arrived; incoming_.pop_due(now, arrived);) serve(arrived, now);
  return outgoing_.pop_due(now, out);
}

void ThimbleWorldEnd::serve(const Arrived& arrived, MonotonicTime now) {
  const ThimbleHeader header = *decode_header(arrived.datagram.view());  // looked at before
  if (header.kind == ThimbleKind::Hello) return serve_hello(arrived, header, now);
  if (header.kind == ThimbleKind::Sample) return serve_sample(arrived, header, now);
  counters_.reject(RejectReason::WrongPeer);  // what a world says
}

void ThimbleWorldEnd::serve_sample(const Arrived& arrived, const ThimbleHeader& header,
                                   MonotonicTime now) {
  const auto found = std::find_if(sessions_.begin(), sessions_.end(), [&](const auto& session) {
    return session->origin().token == header.session;
  });
  if (found == sessions_.end()) {
    ++counters_.stale;  // of a session that ended
    return;
  }
  if (!((*found)->origin().peer == arrived.from)) {
    return counters_.reject(RejectReason::WrongPeer);
  }
  Reply reply{.to = arrived.from, .datagram = {}};
  if ((*found)->serve(header, arrived.datagram.view(), now, reply.datagram)) {
    outgoing_.push(now, reply);
  }
}

void ThimbleWorldEnd::serve_hello(const Arrived& arrived, const ThimbleHeader& header,
                                  MonotonicTime now) {
  std::array<std::byte, kMaxThimbleContent> room;
  ThimbleHello hello;
  const auto content = from_arm_.open(header, arrived.datagram.view(), room);
  const Decoded<void> read = content ? decode(*content, hello) : tl::unexpected(content.error());
  if (!read) return counters_.reject(read.error());
  if (hello.world_nonce == Nonce()) return challenge(arrived.from, hello, now);
  join(arrived.from, hello, now);
}

void ThimbleWorldEnd::challenge(const Endpoint& from, const ThimbleHello& hello,
                                MonotonicTime now) {
  answer_hello(from, ThimbleKind::Challenge,
               ThimbleChallenge{{now, hello.timing.sent_at, now},
                                hello.arm_nonce,
                                challenges_.challenge(from, hello.arm_nonce, now)},
               now);
}

void ThimbleWorldEnd::join(const Endpoint& from, const ThimbleHello& hello, MonotonicTime now) {
  const auto same = std::find_if(sessions_.begin(), sessions_.end(), [&](const auto& session) {
    return session->origin().peer == from;
  });
  if (same != sessions_.end() && (*same)->origin().world_nonce == hello.world_nonce) {
    if (!(*same)->has_begun()) return welcome(**same, hello, now);  // the first was lost
    ++counters_.stale;
    return;
  }
  if (!challenges_.is_good(from, hello.arm_nonce, hello.world_nonce, now)) {
    ++counters_.stale;
    return;
  }
  if (same != sessions_.end()) release(static_cast<std::size_t>(same - sessions_.begin()));
  const bool is_full = sessions_.size() >= settings_.max_sessions;
  const std::size_t outside = longest_outside(now);
  if (is_full && outside == sessions_.size()) {
    return refuse(from, hello, ThimbleRefusalReason::Busy, "no room for another hand", now);
  }
  auto half = make_half(hello);
  if (!half) {
    const bool is_arm = settings_.arm_scheme && (hello.capabilities & kBetweenArms) != 0;
    return refuse(from, hello, is_arm ? ThimbleRefusalReason::Arm : ThimbleRefusalReason::Scheme,
                  half.error().message, now);
  }
  if (!challenges_.use(hello.world_nonce, now)) {
    return refuse(from, hello, ThimbleRefusalReason::Busy, "too many came at once", now);
  }
  refusal_.clear();
  if (is_full) release(outside);  // now that its place is needed
  sessions_.push_back(
      std::make_unique<ThimbleSession>(ThimbleSession::Origin{from, new_token(), hello.arm_nonce,
                                                              hello.world_nonce, hello.half.scheme},
                                       settings_.key, *std::move(half), now));
  welcome(*sessions_.back(), hello, now);
}

void ThimbleWorldEnd::welcome(ThimbleSession& session, const ThimbleHello& hello,
                              MonotonicTime now) {
  ThimbleWelcome message = settings_.welcome;
  message.timing = {now, hello.timing.sent_at, now};
  message.arm_nonce = hello.arm_nonce;
  if (settings_.arm_scheme) message.capabilities |= kBetweenArms;
  Reply reply{.to = session.origin().peer, .datagram = {}};
  if (session.welcome(message, reply.datagram)) outgoing_.push(now, reply);
}

// An arm here is another one's far end as it is: by a stream.
Result<std::unique_ptr<coupling::WorldCoupling>> ThimbleWorldEnd::make_half(
    const ThimbleHello& hello) const {
  if (settings_.arm_scheme && (hello.capabilities & kBetweenArms) == 0) {
    return fail(Errc::Unsupported, "an older program, which cannot be coupled to an arm");
  }
  if (settings_.arm_scheme && (hello.capabilities & kLockStep) != 0) {
    return fail(Errc::Unsupported,
                "two arms are coupled by a stream; the other one is in lock-step");
  }
  return make_half_(hello.half);
}

void ThimbleWorldEnd::refuse(const Endpoint& from, const ThimbleHello& hello,
                             ThimbleRefusalReason reason, const std::string& why,
                             MonotonicTime now) {
  counters_.reject(RejectReason::SessionRefused);
  refusal_ = "refused " + to_string(from) + ": " + why;
  ThimbleRefusal refusal{{now, hello.timing.sent_at, now}, hello.arm_nonce, reason};
  if (reason == ThimbleRefusalReason::Arm) refusal.scheme = *settings_.arm_scheme;
  answer_hello(from, ThimbleKind::Refusal, refusal, now);
}

template <class Message>
void ThimbleWorldEnd::answer_hello(const Endpoint& to, ThimbleKind kind, const Message& message,
                                   MonotonicTime now) {
  Reply reply{.to = to, .datagram = {}};
  const Decoded<void> packed =
      to_arm_.pack({.kind = kind, .sequence = ++handshakes_}, message, random_, reply.datagram);
  if (!packed) return counters_.reject(packed.error());
  ++counters_.sent;
  outgoing_.push(now, reply);
}

std::uint64_t ThimbleWorldEnd::new_token() const {
  std::uint64_t token = 0;
  while (token == 0) random_(std::as_writable_bytes(std::span(&token, 1)));
  return token;
}

void ThimbleWorldEnd::release_silent(MonotonicTime now) {
  for (std::size_t i = sessions_.size(); i > 0; --i) {
    if (now >= sessions_[i - 1]->silent_at()) release(i - 1);
  }
}

std::size_t ThimbleWorldEnd::longest_outside(MonotonicTime now) const noexcept {
  const auto longest = std::min_element(
      sessions_.begin(), sessions_.end(),
      [](const auto& a, const auto& b) { return a->outside_at() < b->outside_at(); });
  const bool is_outside = longest != sessions_.end() && now >= (*longest)->outside_at();
  return is_outside ? static_cast<std::size_t>(longest - sessions_.begin()) : sessions_.size();
}

void ThimbleWorldEnd::release(std::size_t index) {
  ++counters_.sessions_released;
  counters_ = sum(counters_, without_arrivals(sessions_[index]->counters()));
  sessions_.erase(sessions_.begin() + static_cast<std::ptrdiff_t>(index));
}

std::optional<MonotonicTime> ThimbleWorldEnd::next_due() const {
  std::optional<MonotonicTime> due = incoming_.next_due();
  take_earlier(due, outgoing_.next_due());
  for (const auto& session : sessions_) take_earlier(due, session->silent_at());
  return due;
}

std::vector<LinkStatus> ThimbleWorldEnd::sessions() const {
  std::vector<LinkStatus> out;
  out.reserve(sessions_.size());
  for (const auto& session : sessions_) out.push_back(session->status());
  return out;
}

LinkCounters ThimbleWorldEnd::total() const {
  LinkCounters total = counters_;
  for (const auto& session : sessions_) {
    total = sum(total, without_arrivals(session->counters()));
  }
  total.injected = sum(incoming_.counters(), outgoing_.counters());
  return total;
}

}  // namespace thimble::link
