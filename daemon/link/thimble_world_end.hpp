#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/challenge_book.hpp"
#include "daemon/link/endpoint.hpp"
#include "daemon/link/impaired_queue.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/seal.hpp"
#include "daemon/link/thimble_session.hpp"

namespace thimble::link {

// The world's end of our own protocol, without a socket: datagrams in, datagrams out. Each arm has
// a session with a half of the coupling that was made for it; up to `max_sessions` at once, and
// none waits for another. A session begins when who asked for it told a challenge back, and ends by
// a silence of kSilence (kFirstSilence before its first sample), or when the same address begins
// another; one whose hand was not taken for kSilence ends when a newcomer needs its place. Nothing
// is answered with more bytes than it had, but a session that its own peer holds.
// docs/link-protocol.md.
//
// Thread: one, the net plane's. RT: not; allocates while queues grow and when a session begins.
// Ownership: the worlds behind the halves must outlive it. Errors: none end it; all are counted.
class ThimbleWorldEnd {
 public:
  // The world's half for an arm that says so much of its own. Errors: there is none.
  using MakeHalf =
      std::function<Result<std::unique_ptr<coupling::WorldCoupling>>(const ThimbleHalf& arm)>;
  struct Settings {
    ImpairmentSettings impairment{};        // validated by the caller
    std::optional<Endpoint> pinned_peer{};  // only this address, whatever its port
    std::optional<LinkKey> key{};
    std::size_t max_sessions{8};  // ours: world::kMaxProbes, a world takes no more hands
    ThimbleWelcome welcome{};     // what is told of the world
    // There is no world here, but an arm with this scheme (coupling/arm_pair.hpp): who cannot be
    // coupled to an arm is refused.
    std::optional<ShortName> arm_scheme{};
  };
  struct Reply {
    Endpoint to{};
    ThimbleDatagram datagram{};
  };

  ThimbleWorldEnd(const Settings& settings, MakeHalf make_half, RandomBytes random);

  // Takes what a socket received, of any size. Says why it was refused at sight; what a seal hides
  // is found out when the injected delay has passed, and shows in the counters only.
  std::optional<RejectReason> on_datagram(const Endpoint& from, std::span<const std::byte> bytes,
                                          MonotonicTime now);
  // True and `out` set when a reply is to leave; call until false.
  bool poll(MonotonicTime now, Reply& out);
  // When to poll again at the latest; a datagram comes on top.
  [[nodiscard]] std::optional<MonotonicTime> next_due() const;
  // Of each session there is.
  [[nodiscard]] std::vector<LinkStatus> sessions() const;
  // Of all that there were, and of what belonged to none.
  [[nodiscard]] LinkCounters total() const;
  // Who was refused last and why, for a person; empty when a session began since.
  [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }
  // For the socket to count its errors.
  [[nodiscard]] LinkCounters& counters() noexcept { return counters_; }

 private:
  struct Arrived {
    Endpoint from{};
    ThimbleDatagram datagram{};
  };

  void serve(const Arrived& arrived, MonotonicTime now);
  void serve_hello(const Arrived& arrived, const ThimbleHeader& header, MonotonicTime now);
  void serve_sample(const Arrived& arrived, const ThimbleHeader& header, MonotonicTime now);
  void challenge(const Endpoint& from, const ThimbleHello& hello, MonotonicTime now);
  void join(const Endpoint& from, const ThimbleHello& hello, MonotonicTime now);
  void welcome(ThimbleSession& session, const ThimbleHello& hello, MonotonicTime now);
  void refuse(const Endpoint& from, const ThimbleHello& hello, ThimbleRefusalReason reason,
              const std::string& why, MonotonicTime now);
  [[nodiscard]] Result<std::unique_ptr<coupling::WorldCoupling>> make_half(
      const ThimbleHello& hello) const;
  template <class Message>
  void answer_hello(const Endpoint& to, ThimbleKind kind, const Message& message,
                    MonotonicTime now);
  [[nodiscard]] std::uint64_t new_token() const;
  void release_silent(MonotonicTime now);
  // Index of the session whose place another one may have, the longest outside; none: size().
  [[nodiscard]] std::size_t longest_outside(MonotonicTime now) const noexcept;
  void release(std::size_t index);

  Settings settings_;
  MakeHalf make_half_;
  RandomBytes random_;
  ChallengeBook challenges_;
  Seal from_arm_;  // of handshakes
  Seal to_arm_;
  ImpairedQueue<Arrived> incoming_;
  ImpairedQueue<Reply> outgoing_;
  std::vector<std::unique_ptr<ThimbleSession>> sessions_;
  std::uint64_t handshakes_{0};
  std::string refusal_;
  LinkCounters counters_{};  // of no session, and of those that ended
};

}  // namespace thimble::link
