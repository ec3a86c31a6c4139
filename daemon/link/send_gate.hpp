#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/time.hpp"

namespace thimble::link {

enum class SendMode : std::uint8_t {
  Streamed,  // every sample of the servo
  LockStep,  // the next one after the reply, as the client of 1999 did
};

// Says when the next sample may leave. In lock-step that is after the reply to the last one,
// or when that reply is overdue: a lost message costs a time-out, never the link.
//
// Over a carriage without numbers a reply that comes after a time-out may belong to the
// request before; taking it for the answer would leave the link one reply behind for ever
// (teleop.md 7 row 3). The gate then waits until no reply came for two more time-outs, the
// widest gap between replies to what was sent meanwhile, and sends into the empty link.
//
// Thread: one. RT: allocation-free. Errors: none.
class SendGate {
 public:
  static constexpr Duration kMinTimeout = std::chrono::milliseconds(20);  // DESIGN section 4
  // While the round trip is unknown, and the end of doubling: constraints fade at that age.
  static constexpr Duration kMaxTimeout = std::chrono::milliseconds(250);

  explicit SendGate(SendMode mode) noexcept : mode_(mode) {}

  [[nodiscard]] bool may_send(MonotonicTime now) const noexcept;
  // `round_trip`: smoothed, 0 while unknown.
  void on_sent(MonotonicTime now, Duration round_trip) noexcept;
  // The reply to the last sample sent, beyond doubt.
  void on_answered() noexcept;
  // A reply, to the last sample as far as one can tell.
  void on_reply(MonotonicTime now) noexcept;
  // True when a reply now can not be told from a late one: it measures no round trip.
  [[nodiscard]] bool is_ambiguous() const noexcept { return is_ambiguous_; }
  // When the gate opens by itself.
  [[nodiscard]] std::optional<MonotonicTime> deadline() const noexcept;
  [[nodiscard]] std::uint64_t timed_out() const noexcept { return timed_out_; }

 private:
  SendMode mode_;
  bool is_waiting_{false};
  bool is_ambiguous_{false};
  bool is_draining_{false};
  std::uint32_t back_off_{0};
  Duration timeout_{kMaxTimeout};
  MonotonicTime deadline_{};
  std::uint64_t timed_out_{0};
};

}  // namespace thimble::link
