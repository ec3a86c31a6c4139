#pragma once

#include <memory>
#include <optional>

#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/clock_offset.hpp"
#include "daemon/link/endpoint.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/round_trip.hpp"
#include "daemon/link/seal.hpp"
#include "daemon/link/sequence_window.hpp"
#include "daemon/link/world_session.hpp"

namespace thimble::link {

// One arm at a world's end: its keys, its numbers, and its own half of the coupling. A sample that
// is not newer than all before it is counted and moves nothing. A world that has nothing to say, or
// refuses the hand for now, is heard as such: the link stands and the constraints grow old.
//
// Thread: one, the net plane's. RT: not; allocates nothing once made.
// Ownership: its half of the coupling; the world behind that must outlive it. Errors: counted.
class ThimbleSession {
 public:
  struct Origin {
    Endpoint peer{};
    std::uint64_t token{0};
    Nonce arm_nonce{};
    Nonce world_nonce{};
    ShortName scheme{};  // that the arm asked for
  };

  // `key`: nothing is sealed without.
  ThimbleSession(const Origin& origin, const std::optional<LinkKey>& key,
                 std::unique_ptr<coupling::WorldCoupling> half, MonotonicTime now);

  [[nodiscard]] const Origin& origin() const noexcept { return origin_; }
  // With the next number. Whether `out` is to be sent.
  bool welcome(const ThimbleWelcome& welcome, ThimbleDatagram& out);
  // Whether `out` is to be sent.
  bool serve(const ThimbleHeader& header, std::span<const std::byte> datagram, MonotonicTime now,
             ThimbleDatagram& out);
  [[nodiscard]] bool has_begun() const noexcept { return has_begun_; }  // a sample came
  [[nodiscard]] MonotonicTime silent_at() const noexcept {
    return heard_at_ + (has_begun_ ? kSilence : kFirstSilence);
  }
  // From then on it is one that sends, but whose hand was not taken for that long: another one may
  // have its place.
  [[nodiscard]] MonotonicTime outside_at() const noexcept { return inside_at_ + kSilence; }
  [[nodiscard]] LinkStatus status() const;
  [[nodiscard]] const LinkCounters& counters() const noexcept { return counters_; }

 private:
  struct Told {  // which set the world gave last; none has number 0
    std::uint32_t session{0};
    std::uint64_t sequence{0};
    bool operator==(const Told&) const = default;
  };

  bool is_newest(std::uint64_t sequence) noexcept;
  void heard(const ThimbleTiming& timing, MonotonicTime now) noexcept;
  [[nodiscard]] bool is_in_world(const coupling::HandSample& sample, MonotonicTime now);
  template <class Message>
  bool send(ThimbleKind kind, const Message& message, ThimbleDatagram& out);

  Origin origin_;
  Seal from_arm_;
  Seal to_arm_;
  std::unique_ptr<coupling::WorldCoupling> half_;
  WorldSession session_;
  SequenceWindow arrived_;
  std::uint64_t sequence_{0};
  std::uint32_t restart_{0};
  bool has_begun_{false};
  std::optional<Told> told_;
  std::optional<MonotonicTime> retry_at_;  // the world refused, or was asked; not asked before
  MonotonicTime heard_at_{};
  MonotonicTime inside_at_{};
  RoundTrip round_trip_;
  ClockOffset clocks_;
  LinkCounters counters_{};
};

}  // namespace thimble::link
