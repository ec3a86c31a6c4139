#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "daemon/coupling/arm_link.hpp"
#include "daemon/coupling/messages.hpp"
#include "daemon/link/impaired_queue.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/outstanding_requests.hpp"
#include "daemon/link/round_trip.hpp"
#include "daemon/link/send_gate.hpp"
#include "daemon/link/thesis_codec.hpp"

namespace thimble::link {

// The client's end of the 1999 protocol, without a socket: hand samples and datagrams in,
// datagrams and constraints out.
//
// The protocol has no numbers: which request a reply answers, the round trip and the losses
// are estimates (OutstandingRequests). A reply after a silence of kSilence begins a new
// session, because the peer may have been restarted; a restart within that time shows only
// as constraints that change. While the link is down it asks like a client in lock-step,
// one request at a time: no flood for a dead peer, and a first round trip that is measured.
// docs/thesis-protocol.md.
//
// Thread: one, the net plane's. RT: not; allocates only while queues grow.
// Errors: none end it; all are counted.
class ThesisArmEnd {
 public:
  struct Settings {
    SendMode mode{SendMode::Streamed};
    ImpairmentSettings impairment{};  // validated by the caller
  };

  explicit ThesisArmEnd(const Settings& settings);

  // Replaces a sample that has not left yet.
  void offer(const coupling::HandSample& sample) noexcept { pending_ = sample; }
  // True and `out` set when a datagram is to leave; call until false.
  bool poll(MonotonicTime now, ThesisRequest& out);
  // Takes what a socket received from the peer, of any size; says why it was refused.
  std::optional<RejectReason> on_datagram(std::span<const std::byte> bytes, MonotonicTime now);
  // True and `out` set when a reply comes into force; call until false.
  bool take_reply(MonotonicTime now, coupling::ConstraintSet& out);
  // When to poll and take again at the latest.
  [[nodiscard]] std::optional<MonotonicTime> next_due() const;
  [[nodiscard]] coupling::LinkQuality quality() const noexcept;
  [[nodiscard]] LinkStatus status() const;
  // For the socket to count its errors.
  [[nodiscard]] LinkCounters& counters() noexcept { return counters_; }

 private:
  [[nodiscard]] bool is_streaming() const noexcept;
  void send_pending(MonotonicTime now);
  [[nodiscard]] bool accept(MonotonicTime now);
  void begin_session(bool is_ambiguous) noexcept;
  void judge_silence(MonotonicTime now) noexcept;

  SendMode mode_;
  SendGate gate_;
  ImpairedQueue<ThesisRequest> outgoing_;
  ImpairedQueue<ThesisReply> incoming_;
  OutstandingRequests outstanding_;
  RoundTrip round_trip_;
  std::optional<coupling::HandSample> pending_;
  std::optional<MonotonicTime> accepted_at_;  // of the newest reply; none: link down
  std::uint32_t session_{0};
  std::uint64_t last_reply_{0};  // of this session
  LinkCounters counters_{};
};

}  // namespace thimble::link
