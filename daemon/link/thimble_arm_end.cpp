#include "daemon/link/thimble_arm_end.hpp"

#include <algorithm>
#include <utility>

#include "daemon/link/earliest.hpp"

namespace thimble::link {
namespace {

constexpr std::size_t kOpenRequests = 4096;  // 0.5 s of round trip at 8 kHz

Seal handshake_seal(const std::optional<LinkKey>& key, Towards towards) noexcept {
  return key ? Seal::of_handshake(*key, towards) : Seal();
}

Capabilities capabilities_of(SendMode mode) noexcept {
  return mode == SendMode::LockStep ? kBetweenArms | kLockStep : kBetweenArms;
}

std::string sentence_of(const ThimbleRefusal& refusal, const ShortName& mine, SendMode mode) {
  const std::string scheme(mine.view());
  if (refusal.reason == ThimbleRefusalReason::Busy) {
    return "the world holds as many hands as it can";
  }
  if (refusal.reason == ThimbleRefusalReason::Scheme) {
    return "the world does not go with the scheme " + scheme;
  }
  if (mode == SendMode::LockStep) {
    return "the far end is an arm, which follows a stream; this arm is in lock-step";
  }
  return "the far end is an arm of the scheme " + std::string(refusal.scheme.view()) +
         ", which does not go with " + scheme;
}

}  // namespace

ThimbleArmEnd::ThimbleArmEnd(const Settings& settings, RandomBytes random)
    : settings_(settings),
      random_(std::move(random)),
      to_world_handshake_(handshake_seal(settings.key, Towards::World)),
      from_world_handshake_(handshake_seal(settings.key, Towards::Arm)),
      gate_(settings.mode),
      deadband_(settings.mode == SendMode::Streamed ? settings.deadband_m : 0),
      outgoing_(settings.impairment, 0),
      incoming_(settings.impairment, 1),
      sent_(kOpenRequests) {}

void ThimbleArmEnd::offer(const coupling::HandSample& sample) noexcept {
  restart_ = sample.restart;
  pending_ = sample;
}

bool ThimbleArmEnd::poll(MonotonicTime now, ThimbleDatagram& out) {
  judge_silence(now);
  if (is_open()) {
    send_pending(now);
  } else {
    ask(now);
  }
  return outgoing_.pop_due(now, out);
}

void ThimbleArmEnd::ask(MonotonicTime now) {
  if (!pending_) return;
  if (!asking_ || now >= asking_->ends) {
    is_second_choice_ = false;
    begin_asking(now, {});
  }
  if (now >= asking_->next_hello) send_hello(now);
}

void ThimbleArmEnd::begin_asking(MonotonicTime now, Duration pause) {
  asking_ = Asking{.next_hello = now + pause, .ends = now + pause + kAttempt};
  random_(asking_->arm_nonce);
}

void ThimbleArmEnd::send_hello(MonotonicTime now) {
  asking_->next_hello = now + kHelloPeriod;
  const ThimbleHello hello{.timing = {.sent_at = now},
                           .arm_nonce = asking_->arm_nonce,
                           .world_nonce = asking_->world_nonce.value_or(Nonce()),
                           .half = half(),
                           .capabilities = capabilities_of(settings_.mode)};
  send(ThimbleKind::Hello, ++hellos_, hello, to_world_handshake_, now);
}

template <class Message>
bool ThimbleArmEnd::send(ThimbleKind kind, std::uint64_t sequence, const Message& message,
                         const Seal& seal, MonotonicTime now) {
  ThimbleDatagram datagram;
  const Decoded<void> packed = seal.pack({.kind = kind, .session = session_, .sequence = sequence},
                                         message, random_, datagram);
  if (!packed) {
    counters_.reject(packed.error());
    return false;
  }
  ++counters_.sent;
  outgoing_.push(now, datagram);
  return true;
}

void ThimbleArmEnd::send_pending(MonotonicTime now) {
  if (!pending_ || !gate_.may_send(now)) return;
  const Duration answer_after = round_trip_.smoothed() + 4 * round_trip_.deviation();
  if (deadband_.may_skip(*pending_, now, answer_after)) {
    ++counters_.withheld;
    return pending_.reset();
  }
  const ThimbleSample message{
      .timing = {.sent_at = now, .echo = echo_.echo, .echoed_at = echo_.echoed_at},
      .sample = *std::exchange(pending_, std::nullopt)};
  const std::uint64_t number = last_number_ + 1;
  if (!send(ThimbleKind::Sample, number, message, to_world_, now)) return;
  last_number_ = number;
  gate_.on_sent(now, round_trip_.smoothed());
  const coupling::HandSample& sample = message.sample;
  deadband_.on_sent(sample, now);
  sent_[number % sent_.size()] = {number, sample.sequence, sample.restart, sample.sampled_at,
                                  now,    sample.hand};
}

std::optional<RejectReason> ThimbleArmEnd::on_datagram(std::span<const std::byte> bytes,
                                                       MonotonicTime now) {
  ++counters_.received;
  const Decoded<ThimbleHeader> header = decode_header(bytes);
  if (!header) {
    counters_.reject(header.error());
    return header.error();
  }
  ThimbleDatagram datagram;
  std::copy(bytes.begin(), bytes.end(), datagram.bytes.begin());
  datagram.size = bytes.size();
  incoming_.push(now, datagram);
  return std::nullopt;
}

bool ThimbleArmEnd::take_reply(MonotonicTime now, coupling::ConstraintSet& out) {
  judge_silence(now);
  for (ThimbleDatagram datagram; incoming_.pop_due(now, datagram);) {
    if (take(datagram, now, out)) return true;
  }
  return false;
}

bool ThimbleArmEnd::take(const ThimbleDatagram& datagram, MonotonicTime now,
                         coupling::ConstraintSet& out) {
  const ThimbleHeader header = *decode_header(datagram.view());  // looked at when it arrived
  switch (header.kind) {
    case ThimbleKind::Challenge:
      take_challenge(header, datagram, now);
      return false;
    case ThimbleKind::Welcome:
      take_welcome(header, datagram, now);
      return false;
    case ThimbleKind::Refusal:
      take_refusal(header, datagram, now);
      return false;
    case ThimbleKind::Constraints:
    case ThimbleKind::Idle:
      return take_from_session(header, datagram, now, out);
    case ThimbleKind::Hello:
    case ThimbleKind::Sample:
      break;
  }
  counters_.reject(RejectReason::WrongPeer);  // what an arm says
  return false;
}

template <class Message>
bool ThimbleArmEnd::read(const ThimbleHeader& header, const ThimbleDatagram& datagram,
                         const Seal& seal, Message& out) {
  std::array<std::byte, kMaxThimbleContent> room;
  const auto content = seal.open(header, datagram.view(), room);
  const Decoded<void> done = content ? decode(*content, out) : tl::unexpected(content.error());
  if (!done) counters_.reject(done.error());
  return done.has_value();
}

void ThimbleArmEnd::take_challenge(const ThimbleHeader& header, const ThimbleDatagram& datagram,
                                   MonotonicTime now) {
  ThimbleChallenge challenge;
  if (!read(header, datagram, from_world_handshake_, challenge)) return;
  // Another attempt's, or a copy: one challenge is taken up, so that one key is agreed upon.
  const bool is_mine = asking_ && challenge.arm_nonce == asking_->arm_nonce;
  if (!is_mine || asking_->world_nonce) {
    ++counters_.stale;
    return;
  }
  asking_->world_nonce = challenge.world_nonce;
  send_hello(now);
}

void ThimbleArmEnd::take_welcome(const ThimbleHeader& header, const ThimbleDatagram& datagram,
                                 MonotonicTime now) {
  if (!asking_ || !asking_->world_nonce || header.session == 0) {
    ++counters_.stale;
    return;
  }
  Seal seal;
  if (settings_.key) {
    seal = Seal::of_session(*settings_.key, Towards::Arm, asking_->arm_nonce, *asking_->world_nonce,
                            header.session);
  }
  ThimbleWelcome welcome;
  if (!read(header, datagram, seal, welcome)) return;
  if (welcome.arm_nonce != asking_->arm_nonce) {
    ++counters_.stale;
    return;
  }
  from_world_ = seal;
  if (settings_.key) {
    to_world_ = Seal::of_session(*settings_.key, Towards::World, asking_->arm_nonce,
                                 *asking_->world_nonce, header.session);
  }
  session_ = header.session;
  asking_.reset();
  world_ = welcome;
  last_number_ = 0;
  accounted_ = 0;
  std::fill(sent_.begin(), sent_.end(), Sent());
  arrived_ = {};
  arrived_.note(header.sequence);
  gate_.on_answered();
  deadband_.reset();
  ++epoch_;
  told_session_ = 0;
  last_error_.clear();
  ++counters_.sessions_opened;
  has_begun_ = false;
  heard(welcome.timing, now);
}

void ThimbleArmEnd::take_refusal(const ThimbleHeader& header, const ThimbleDatagram& datagram,
                                 MonotonicTime now) {
  ThimbleRefusal refusal;
  if (!read(header, datagram, from_world_handshake_, refusal)) return;
  if (!asking_ || refusal.arm_nonce != asking_->arm_nonce) {
    ++counters_.stale;
    return;
  }
  counters_.reject(RejectReason::SessionRefused);
  if (refusal.reason != ThimbleRefusalReason::Busy && settings_.else_half && !is_second_choice_) {
    is_second_choice_ = true;
    return begin_asking(now, {});
  }
  last_error_ = sentence_of(refusal, half().scheme, settings_.mode);
  is_second_choice_ = false;
  begin_asking(now, kRefusedPause);
}

bool ThimbleArmEnd::take_from_session(const ThimbleHeader& header, const ThimbleDatagram& datagram,
                                      MonotonicTime now, coupling::ConstraintSet& out) {
  if (!is_open() || header.session != session_) {
    ++counters_.stale;
    return false;
  }
  ThimbleConstraints constraints;
  ThimbleIdle idle;
  const bool is_idle = header.kind == ThimbleKind::Idle;
  const bool is_read = is_idle ? read(header, datagram, from_world_, idle)
                               : read(header, datagram, from_world_, constraints);
  if (!is_read) return false;
  const SequenceWindow::Verdict verdict = arrived_.note(header.sequence).verdict;
  if (verdict != SequenceWindow::Verdict::Newest) {
    ++counters_.stale;
    if (verdict == SequenceWindow::Verdict::Duplicate) {
      ++counters_.duplicated;
      return false;
    }
    ++counters_.reordered;
    if (counters_.lost > 0) --counters_.lost;  // it was counted when the newer one came
    return false;
  }
  has_begun_ = true;
  heard(is_idle ? idle.timing : constraints.timing, now);
  if (!is_idle) return accept(constraints, now, out);
  account(idle.request);
  return false;
}

void ThimbleArmEnd::heard(const ThimbleTiming& timing, MonotonicTime now) noexcept {
  heard_at_ = now;
  echo_ = {.sent_at = {}, .echo = timing.sent_at, .echoed_at = now};
  const bool is_whole = timing.echo > MonotonicTime() && timing.echoed_at > MonotonicTime();
  if (is_whole) clocks_.note({timing.echo, timing.echoed_at, timing.sent_at, now});
}

void ThimbleArmEnd::account(std::uint64_t request) noexcept {
  if (request == last_number_) {
    gate_.on_answered();
    // What waited was made before this reply is in force (teleop.md 7 row 8): the next one is not.
    if (settings_.mode == SendMode::LockStep) pending_.reset();
  }
  if (request <= accounted_ || request > last_number_) return;
  counters_.lost += request - accounted_ - 1;
  accounted_ = request;
}

bool ThimbleArmEnd::accept(const ThimbleConstraints& reply, MonotonicTime now,
                           coupling::ConstraintSet& out) {
  const Sent& sent = sent_[reply.request % sent_.size()];
  if (reply.request == 0 || sent.number != reply.request) {  // never sent, or too long ago
    ++counters_.stale;
    return false;
  }
  account(reply.request);
  deadband_.on_answered(sent.hand, sent.sent_at);
  accepted_at_ = now;
  round_trip_.note(now - sent.sent_at);
  if (sent.restart != restart_) {  // proves the link, but its ghost is gone
    ++counters_.stale;
    return false;
  }
  // Numbers of a world that restarted may be those of before.
  const bool is_other = told_session_ != 0 && told_session_ != reply.set.session;
  if (is_other) ++epoch_;
  told_session_ = reply.set.session;
  ++counters_.accepted;
  out = reply.set;
  out.session = epoch_;
  out.answers = sent.sequence;
  out.sampled_at = sent.sampled_at;
  return true;
}

std::optional<MonotonicTime> ThimbleArmEnd::silent_at() const noexcept {
  if (!heard_at_) return std::nullopt;
  return *heard_at_ + (has_begun_ ? kSilence : kFirstSilence);
}

void ThimbleArmEnd::judge_silence(MonotonicTime now) noexcept {
  if (accepted_at_ && now >= *accepted_at_ + kSilence) {
    accepted_at_.reset();
    round_trip_.reset();
  }
  if (!heard_at_ || now < *silent_at()) return;
  heard_at_.reset();
  accepted_at_.reset();
  round_trip_.reset();
  clocks_.reset();
  session_ = 0;
  is_second_choice_ = false;
  to_world_ = Seal();
  from_world_ = Seal();
  echo_ = {};
  ++counters_.sessions_released;
}

std::optional<MonotonicTime> ThimbleArmEnd::next_due() const {
  std::optional<MonotonicTime> due = outgoing_.next_due();
  take_earlier(due, incoming_.next_due());
  if (pending_ && is_open()) take_earlier(due, gate_.deadline());
  if (pending_ && asking_ && !is_open()) take_earlier(due, asking_->next_hello);
  take_earlier(due, silent_at());
  if (accepted_at_) take_earlier(due, *accepted_at_ + kSilence);
  return due;
}

coupling::LinkQuality ThimbleArmEnd::quality() const noexcept {
  return {.is_up = accepted_at_.has_value(),
          .round_trip = round_trip_.smoothed(),
          .jitter = round_trip_.deviation()};
}

LinkStatus ThimbleArmEnd::status() const {
  LinkStatus status;
  status.is_up = accepted_at_.has_value();
  if (is_open()) {
    const bool is_arm = (world_.capabilities & kBetweenArms) != 0;
    (is_arm ? status.arm : status.world) = world_.world.view();
    status.scheme = half().scheme.view();
    status.hears_actions = (world_.capabilities & kHearsActions) != 0;
  }
  if (is_open() && settings_.else_half) {
    status.scheme_reason = is_second_choice_ ? "the world does not go with " +
                                                   std::string(settings_.half.scheme.view())
                                             : "the world goes with it";
  }
  status.last_error = last_error_;
  status.round_trip = round_trip_.smoothed();
  status.jitter = round_trip_.deviation();
  if (clocks_.is_known()) status.clocks = clocks_.status();
  status.counters = counters_;
  status.counters.timed_out = gate_.timed_out();
  status.counters.injected = sum(outgoing_.counters(), incoming_.counters());
  return status;
}

}  // namespace thimble::link
