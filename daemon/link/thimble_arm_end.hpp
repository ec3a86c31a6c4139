#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/coupling/arm_link.hpp"
#include "daemon/coupling/messages.hpp"
#include "daemon/link/clock_offset.hpp"
#include "daemon/link/deadband.hpp"
#include "daemon/link/impaired_queue.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/round_trip.hpp"
#include "daemon/link/seal.hpp"
#include "daemon/link/send_gate.hpp"
#include "daemon/link/sequence_window.hpp"

namespace thimble::link {

// The arm's end of our own protocol, without a socket: hand samples and datagrams in, datagrams and
// constraints out. While there is a sample to send and no session it asks for one, once a
// kHelloPeriod; a silence of kSilence ends the session, of kFirstSilence before its first reply. A
// reply is matched with the sample that it answers by the sample's number, so round trip and losses
// are exact. Where it has two halves of a coupling to ask for, each session begins with the first:
// another world may be there by then. docs/link-protocol.md.
//
// Thread: one, the net plane's. RT: not; allocates only while queues grow.
// Errors: none end it; all are counted. What the world refuses is said in status().
class ThimbleArmEnd {
 public:
  struct Settings {
    SendMode mode{SendMode::Streamed};
    ImpairmentSettings impairment{};  // validated by the caller
    std::optional<LinkKey> key{};
    ThimbleHalf half{.scheme = ShortName::of("ghost-point")};
    // Asked for where the world has none for `half`; the arm half has to go with both.
    std::optional<ThimbleHalf> else_half{};
    double deadband_m{0};  // of a stream; 0: every sample is sent
  };
  // Ours: four in a kSilence, so that one that is lost delays a session by less than a silence
  // does.
  static constexpr Duration kHelloPeriod = std::chrono::milliseconds(250);
  // Ours: a handshake is two round trips of the longest delay that can be injected, 2 s each; then
  // all is asked anew.
  static constexpr Duration kAttempt = std::chrono::seconds(5);
  // Ours: a kSilence, after which the place of who is gone is free.
  static constexpr Duration kRefusedPause = std::chrono::seconds(1);

  ThimbleArmEnd(const Settings& settings, RandomBytes random);

  // Replaces a sample that has not left yet.
  void offer(const coupling::HandSample& sample) noexcept;
  // True and `out` set when a datagram is to leave; call until false.
  bool poll(MonotonicTime now, ThimbleDatagram& out);
  // Takes what a socket received from the peer, of any size; says why it was refused at sight. What
  // a seal hides is found out when the injected delay has passed, and shows in the counters only.
  std::optional<RejectReason> on_datagram(std::span<const std::byte> bytes, MonotonicTime now);
  // True and `out` set when a reply comes into force; call until false, then poll().
  bool take_reply(MonotonicTime now, coupling::ConstraintSet& out);
  // When to poll and take again at the latest.
  [[nodiscard]] std::optional<MonotonicTime> next_due() const;
  [[nodiscard]] coupling::LinkQuality quality() const noexcept;
  [[nodiscard]] LinkStatus status() const;
  // For the socket to count its errors.
  [[nodiscard]] LinkCounters& counters() noexcept { return counters_; }

 private:
  struct Sent {  // what a reply is matched with
    std::uint64_t number{0};
    std::uint64_t sequence{0};
    std::uint32_t restart{0};
    MonotonicTime sampled_at{};
    MonotonicTime sent_at{};
    Position3 hand{};
  };
  struct Asking {  // for a session
    Nonce arm_nonce{};
    std::optional<Nonce> world_nonce{};
    MonotonicTime next_hello{};
    MonotonicTime ends{};
  };

  [[nodiscard]] bool is_open() const noexcept { return session_ != 0; }
  // What is asked for, or was, as long as the session lasts.
  [[nodiscard]] const ThimbleHalf& half() const noexcept {
    return is_second_choice_ ? *settings_.else_half : settings_.half;
  }
  void ask(MonotonicTime now);
  void begin_asking(MonotonicTime now, Duration pause);
  void send_hello(MonotonicTime now);
  void send_pending(MonotonicTime now);
  template <class Message>
  bool send(ThimbleKind kind, std::uint64_t sequence, const Message& message, const Seal& seal,
            MonotonicTime now);
  bool take(const ThimbleDatagram& datagram, MonotonicTime now, coupling::ConstraintSet& out);
  void take_challenge(const ThimbleHeader& header, const ThimbleDatagram& datagram,
                      MonotonicTime now);
  void take_welcome(const ThimbleHeader& header, const ThimbleDatagram& datagram,
                    MonotonicTime now);
  void take_refusal(const ThimbleHeader& header, const ThimbleDatagram& datagram,
                    MonotonicTime now);
  bool take_from_session(const ThimbleHeader& header, const ThimbleDatagram& datagram,
                         MonotonicTime now, coupling::ConstraintSet& out);
  void account(std::uint64_t request) noexcept;
  bool accept(const ThimbleConstraints& reply, MonotonicTime now, coupling::ConstraintSet& out);
  template <class Message>
  bool read(const ThimbleHeader& header, const ThimbleDatagram& datagram, const Seal& seal,
            Message& out);
  void heard(const ThimbleTiming& timing, MonotonicTime now) noexcept;
  // When the session, if there is one, ends unless something is heard.
  [[nodiscard]] std::optional<MonotonicTime> silent_at() const noexcept;
  void judge_silence(MonotonicTime now) noexcept;

  Settings settings_;
  RandomBytes random_;
  Seal to_world_handshake_;
  Seal from_world_handshake_;
  Seal to_world_;
  Seal from_world_;
  SendGate gate_;
  Deadband deadband_;
  ImpairedQueue<ThimbleDatagram> outgoing_;
  ImpairedQueue<ThimbleDatagram> incoming_;
  std::optional<coupling::HandSample> pending_;
  std::uint32_t restart_{0};  // of the newest sample the servo gave
  std::optional<Asking> asking_;
  bool is_second_choice_{false};
  std::uint64_t hellos_{0};
  std::uint64_t session_{0};  // 0: none
  ThimbleWelcome world_{};
  std::uint64_t last_number_{0};
  std::uint64_t accounted_{0};  // numbers up to here were answered or are counted as lost
  std::vector<Sent> sent_;      // by number, modulo its size
  SequenceWindow arrived_;
  ThimbleTiming echo_{};                      // of what was heard last
  std::optional<MonotonicTime> heard_at_;     // anything of the session
  bool has_begun_{false};                     // a sample of it was replied to
  std::optional<MonotonicTime> accepted_at_;  // of the newest reply; none: link down
  std::uint32_t told_session_{0};             // of the constraints that the world gave last
  std::uint32_t epoch_{0};                    // session as the coupling is told it
  RoundTrip round_trip_;
  ClockOffset clocks_;
  std::string last_error_;
  LinkCounters counters_{};
};

}  // namespace thimble::link
