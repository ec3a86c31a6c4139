#include "daemon/link/send_gate.hpp"

#include <algorithm>

namespace thimble::link {
namespace {

constexpr std::uint32_t kMaxBackOff = 4;  // doublings; 20 ms then exceeds kMaxTimeout

Duration timeout_for(Duration round_trip, std::uint32_t back_off) noexcept {
  const bool is_known = round_trip > Duration::zero();
  const Duration base =
      is_known ? std::max(3 * round_trip, SendGate::kMinTimeout) : SendGate::kMaxTimeout;
  return std::max(base, std::min(base * (1U << back_off), SendGate::kMaxTimeout));
}

}  // namespace

bool SendGate::may_send(MonotonicTime now) const noexcept {
  return mode_ == SendMode::Streamed || !is_waiting_ || now >= deadline_;
}

void SendGate::on_sent(MonotonicTime now, Duration round_trip) noexcept {
  if (mode_ == SendMode::Streamed) return;
  if (is_draining_) {
    is_ambiguous_ = false;
  } else if (is_waiting_) {
    ++timed_out_;
    back_off_ = std::min(back_off_ + 1, kMaxBackOff);
    is_ambiguous_ = true;
  }
  is_draining_ = false;
  is_waiting_ = true;
  timeout_ = timeout_for(round_trip, back_off_);
  deadline_ = now + timeout_;
}

void SendGate::on_answered() noexcept {
  is_waiting_ = false;
  is_ambiguous_ = false;
  is_draining_ = false;
  back_off_ = 0;
}

void SendGate::on_reply(MonotonicTime now) noexcept {
  if (!is_waiting_) return;
  if (!is_ambiguous_) return on_answered();
  is_draining_ = true;
  deadline_ = now + 2 * timeout_;
}

std::optional<MonotonicTime> SendGate::deadline() const noexcept {
  if (!is_waiting_) return std::nullopt;
  return deadline_;
}

}  // namespace thimble::link
