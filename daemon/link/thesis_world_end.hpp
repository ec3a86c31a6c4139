#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "daemon/link/endpoint.hpp"
#include "daemon/link/impaired_queue.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/thesis_codec.hpp"
#include "daemon/link/world_session.hpp"

namespace thimble::link {

// The server's end of the 1999 protocol, without a socket: datagrams in, datagrams out.
//
// One peer holds the session: the first to send a valid request. It loses it by a silence of
// kSilence. Every request of its gets exactly one reply, duplicates and bursts included: a
// client of 1999 blocks for ever when one is missing. For the same reason the newest request of
// another peer is kept while it is refused, and answered once the session is free.
// Malformed datagrams neither open nor hold a session. docs/thesis-protocol.md.
//
// Thread: one, the net plane's. RT: not; allocates only while queues grow.
// Ownership: the world must outlive it. Errors: none end it; all are counted.
class ThesisWorldEnd {
 public:
  struct Settings {
    ImpairmentSettings impairment{};        // validated by the caller
    std::optional<Endpoint> pinned_peer{};  // only this address, whatever its port
  };
  struct Reply {
    Endpoint to{};
    ThesisReply bytes{};
  };
  static constexpr Duration kRetry = WorldSession::kRetry;

  ThesisWorldEnd(const Settings& settings, coupling::WorldCoupling& world);

  // Takes what a socket received, of any size. Says why it was refused at sight; a wrong peer
  // is found out when the injected delay has passed, and shows in the counters only.
  std::optional<RejectReason> on_datagram(const Endpoint& from, std::span<const std::byte> bytes,
                                          MonotonicTime now);
  // True and `out` set when a reply is to leave; call until false.
  bool poll(MonotonicTime now, Reply& out);
  // When to poll again at the latest; a datagram comes on top.
  [[nodiscard]] std::optional<MonotonicTime> next_due() const;
  [[nodiscard]] LinkStatus status() const;
  // For the socket to count its errors.
  [[nodiscard]] LinkCounters& counters() noexcept { return counters_; }

 private:
  struct Request {
    Endpoint from{};
    Position3 hand{};
  };

  void serve(const Request& request, MonotonicTime now);
  void serve_waiting(MonotonicTime now);
  void keep_waiting(const Request& request, MonotonicTime retry_at);

  std::optional<Endpoint> pinned_peer_;
  WorldSession session_;
  Endpoint peer_{};  // valid while the session is open
  ImpairedQueue<Request> incoming_;
  ImpairedQueue<Reply> outgoing_;
  std::optional<Request> waiting_;
  MonotonicTime retry_at_{};
  std::uint64_t last_sequence_{0};
  LinkCounters counters_{};
};

}  // namespace thimble::link
