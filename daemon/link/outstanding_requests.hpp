#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/base/time.hpp"

namespace thimble::link {

// Estimates round trips and losses of a protocol without numbers: the oldest request still
// open is taken for the one a reply answers.
//
// It is an estimate. Each lost datagram makes the next matches one sending period too old;
// once a request is older than max(3 × shortest, shortest + 20 ms) a loss is presumed and
// everything older than the shortest round trip is dropped, so the error stays below
// that. A true lengthening of the way beyond the same bound is taken for loss, until
// a reply comes that nothing asked for, or the link was silent: then all is learned anew.
// With one request in flight at a time it is exact.
//
// Thread: one. RT: bounded by the capacity, allocation-free. Errors: none.
class OutstandingRequests {
 public:
  static constexpr std::size_t kCapacity = 4096;  // 0.5 s of round trip at 8 kHz
  // The least age at which frames freeze (DESIGN section 4), as SendGate::kMinTimeout.
  static constexpr Duration kSlack = std::chrono::milliseconds(20);
  // While no round trip is known. Ours: kSilence, after which the peer is gone.
  static constexpr Duration kUnknownLimit = std::chrono::seconds(1);

  void on_sent(MonotonicTime now) noexcept;
  // The age of the request it is taken to answer; none: nothing asked for it.
  std::optional<Duration> on_reply(MonotonicTime now) noexcept;
  // Drops what is overdue.
  void expire(MonotonicTime now) noexcept;
  void drop_all() noexcept;  // everything open is lost
  void forget() noexcept;    // and the shortest round trip with it
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

 private:
  [[nodiscard]] Duration limit() const noexcept;
  void drop_oldest() noexcept;
  void drop_older_than(MonotonicTime sent_at) noexcept;

  std::array<MonotonicTime, kCapacity> sent_at_{};
  std::size_t oldest_{0};
  std::size_t size_{0};
  std::optional<Duration> shortest_;
  bool is_resynchronised_{false};  // matches may be too young: they teach nothing
  std::uint64_t lost_{0};
};

}  // namespace thimble::link
