#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "daemon/link/impairment.hpp"
#include "hal/base/time.hpp"

// What a link has to tell of itself. Plain values: the link's thread counts and hands out copies,
// which are any thread's. Not RT where a string is in it. Errors: none.
namespace thimble::link {

// Why a message was refused. Every refusal has exactly one reason and is counted under it.
enum class RejectReason : std::uint8_t {
  WrongSize,     // not the one length the protocol has
  WrongPeer,     // somebody else holds the session, or an address that is not the pinned one
  NonFinite,     // NaN or infinity where a number has a meaning
  OutOfRange,    // further than 10 m from the origin: no arm is that long
  BadDirection,  // both directions of one axis, a bit that does not exist, or a normal not of unit
                 // length
  SessionRefused,  // the world would not let the hand in; tried again
  WrongVersion,    // none that this end speaks, or a kind or flag that it does not know
  Malformed,       // lengths, counts or names that cannot be
  BadSeal,         // another key, changed on its way, or sealed where this end has no key, or not
};
inline constexpr std::size_t kRejectReasons = 9;

// What one end of a link has done since it was made. "Message": a hand sample one way, a
// constraint set the other.
struct LinkCounters {
  std::uint64_t sent{0};
  std::uint64_t received{0};  // everything that arrived, refused or not
  std::uint64_t accepted{0};  // of these, what came into force or was answered
  std::uint64_t lost{0};   // requests that stayed without reply; over the 1999 protocol an estimate
  std::uint64_t stale{0};  // duplicated + reordered + replies that nothing asks for (any more)
  std::uint64_t duplicated{0};  // seen before; 0 where the carriage cannot tell
  std::uint64_t reordered{0};   // overtaken by a newer one; 0 where the carriage cannot tell
  std::uint64_t withheld{0};    // samples that a deadband kept back
  std::uint64_t timed_out{0};   // lock-step: went on without the reply
  std::uint64_t unencodable_planes{0};  // constraints the carriage cannot express
  std::uint64_t send_errors{0};
  std::uint64_t receive_errors{0};
  std::uint64_t sessions_opened{0};
  std::uint64_t sessions_released{0};  // the peer was silent for kSilence
  std::array<std::uint64_t, kRejectReasons> rejected_by_reason{};
  ImpairmentCounters injected{};  // both directions

  void reject(RejectReason reason) noexcept {
    ++rejected_by_reason[static_cast<std::size_t>(reason)];
  }
  [[nodiscard]] std::uint64_t rejected(RejectReason reason) const noexcept {
    return rejected_by_reason[static_cast<std::size_t>(reason)];
  }
  [[nodiscard]] std::uint64_t rejected() const noexcept;
};

[[nodiscard]] LinkCounters sum(const LinkCounters& a, const LinkCounters& b) noexcept;
[[nodiscard]] ImpairmentCounters sum(const ImpairmentCounters& a,
                                     const ImpairmentCounters& b) noexcept;

// Of the peer's clock and the two ways, as far as can be told: ClockOffset.
struct ClockStatus {
  Duration offset{};        // peer's clock minus ours
  Duration offset_error{};  // it is within so much of that, whatever the ways
  Duration way_there{};     // to the peer
  Duration way_back{};
};

// A link as a person sees it. Not for the servo plane.
struct LinkStatus {
  std::string peer;                     // "in process", "udp://127.0.0.1:5001"; empty: nobody yet
  std::string last_error;               // empty: none so far
  std::string world{};                  // what the peer calls its world; empty: it did not say
  std::string arm{};                    // likewise its arm, where that is the far end
  std::string scheme{};                 // for which the world made its half; empty: not known
  std::string scheme_reason{};          // why that one; empty: there was nothing to choose
  bool is_up{false};                    // heard from within kSilence
  bool hears_actions{false};            // of an arm's end: its world has told that it does them
  Duration round_trip{};                // smoothed; 0 until known, and at a world end
  Duration jitter{};                    // mean deviation of the round trip
  std::optional<ClockStatus> clocks{};  // none: the carriage does not tell
  LinkCounters counters{};
};

// A peer that says nothing for so long is gone: the link is down at an arm end, the session
// is free for another at a world end. Ours; four times the age at which constraints fade.
inline constexpr Duration kSilence = std::chrono::seconds(1);
// The same of a session in which nothing has come yet, for what comes first is a whole round trip
// on its way. Ours: twice the longest that can be injected, and some.
inline constexpr Duration kFirstSilence = std::chrono::seconds(5);

}  // namespace thimble::link
