#pragma once

#include <optional>

#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/arm_mailbox.hpp"
#include "daemon/link/impaired_queue.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/round_trip.hpp"
#include "daemon/link/send_gate.hpp"
#include "daemon/link/sequence_window.hpp"
#include "daemon/link/world_session.hpp"

namespace thimble::link {

// Arm and world in one process: carries the newest hand sample to the world half of the
// coupling and its answer back, through the injected impairments. When the arm half was reset
// the session in the world starts again, and replies of the one before are dropped. It knows no
// clock: in real time the net plane pumps it when the servo woke it and when it said to; in virtual
// time a test does, at the same moments with the same outcome.
//
// Thread: arm_end() is for the servo; everything else for one thread of the net plane.
// RT: not, but for the arm end. Ownership: world and wake signal must outlive it.
// Errors: none end it. A world that refuses the hand is asked again by the first sample
//         after WorldSession::kRetry.
class InProcessLink {
 public:
  struct Settings {
    SendMode mode{SendMode::Streamed};
    ImpairmentSettings impairment{};  // validated by the caller
    bool hears_actions{false};        // the world does what is asked in the name of a hand
  };

  InProcessLink(const Settings& settings, coupling::WorldCoupling& world,
                rt::WakeSignal* wake = nullptr);

  [[nodiscard]] coupling::ArmLink& arm_end() noexcept { return mailbox_; }
  // Moves everything that is due. Returns when to come again at the latest; a wake from the
  // servo comes on top. None: only a wake can bring work.
  std::optional<MonotonicTime> pump(MonotonicTime now);
  [[nodiscard]] LinkStatus status() const;

 private:
  struct Carried {  // numbered by the link: the servo may start its own numbers again
    std::uint64_t number{0};
    MonotonicTime sent_at{};
  };
  struct CarriedSample {
    Carried carried{};
    coupling::HandSample sample{};
  };
  struct CarriedReply {
    Carried carried{};
    std::uint32_t restart{0};  // of the sample it answers
    coupling::ConstraintSet reply{};
  };

  struct Told {  // which set the world gave last; none has number 0
    std::uint32_t session{0};
    std::uint64_t sequence{0};
    bool operator==(const Told&) const = default;
  };

  void take_sample();
  void send_pending(MonotonicTime now);
  void serve_world(MonotonicTime now);
  bool open_session(const coupling::HandSample& first, MonotonicTime now);
  void accept_replies(MonotonicTime now);
  void accept(const CarriedReply& arrived, MonotonicTime now);
  void count_unanswered(MonotonicTime now) noexcept;
  [[nodiscard]] std::optional<MonotonicTime> next_due() const;

  bool is_lock_step_;
  bool hears_actions_;
  ArmMailbox mailbox_;
  WorldSession session_;
  SendGate gate_;
  ImpairedQueue<CarriedSample> to_world_;
  ImpairedQueue<CarriedReply> to_arm_;
  std::optional<coupling::HandSample> pending_;
  std::uint64_t last_number_{0};
  std::uint32_t restart_{0};         // of the newest sample the servo gave
  std::uint64_t served_{0};          // newest number that reached the world
  std::uint32_t served_restart_{0};  // of that sample
  std::optional<Told> told_;
  std::optional<MonotonicTime> retry_at_;  // the world refused; not asked before
  SequenceWindow arrived_;
  std::uint64_t accounted_{0};      // every number up to here was answered or is counted as lost
  std::optional<Carried> overdue_;  // up to its number all are lost kSilence after its time
  RoundTrip round_trip_;
  std::optional<MonotonicTime> accepted_at_;  // of the newest reply; none: link down
  LinkCounters counters_{};
};

}  // namespace thimble::link
