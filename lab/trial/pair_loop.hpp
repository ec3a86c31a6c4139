#pragma once

#include <array>
#include <memory>
#include <optional>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/arm_pair.hpp"
#include "daemon/link/in_process_link.hpp"
#include "hal/base/time.hpp"
#include "lab/trial/datagram_link.hpp"

namespace thimble::lab {

// Two arms that are each other's far end (coupling/arm_pair.hpp), each at the daemon's own link, in
// virtual time. From one arm to the other and back it takes both links' round trips. Both are in
// one program, or one of them on another host, whose link is then our own datagrams.
//
// Thread: one. Ownership: the arm halves. Errors: none; the settings of the links must be valid.
class PairLoop {
 public:
  struct Arm {
    std::unique_ptr<coupling::ArmCoupling> half;
    coupling::PeerAnswer answer{coupling::PeerAnswer::Motion};
    link::ImpairmentSettings impairment{};
    // Of the second one only: it is on another host, with a link of these settings, but the
    // impairment above.
    std::optional<DatagramLink::Settings> guest{};
  };
  struct Seen {
    Position3 tip{};
    Velocity3 velocity{};  // as the servo has it
  };
  PairLoop(Arm first, Arm second, Duration dt = std::chrono::milliseconds(1));

  // One tick of both servos; of an arm that is not up nothing is asked and nothing said.
  std::array<coupling::ArmOutput, 2> tick(const std::array<Seen, 2>& seen);
  std::array<bool, 2> is_up{true, true};
  [[nodiscard]] Duration dt() const noexcept { return dt_; }
  // Of the second arm; nullptr where it is no guest.
  [[nodiscard]] DatagramLink* guest() noexcept { return guest_ ? &*guest_ : nullptr; }
  // That one begins anew, as a program that has another arm half.
  void restart_guest(std::unique_ptr<coupling::ArmCoupling> half, Position3 tip);

 private:
  void run_links_until(MonotonicTime end);
  [[nodiscard]] coupling::ArmLink& end_of(std::size_t arm) noexcept {
    return links_[arm] ? links_[arm]->arm_end() : guest_->arm_end();
  }
  std::optional<MonotonicTime> pump(std::size_t arm, MonotonicTime now) {
    return links_[arm] ? links_[arm]->pump(now) : guest_->pump(now);
  }
  void invite(const coupling::ArmPair& pair);

  std::array<Arm, 2> arms_;
  std::array<std::unique_ptr<coupling::WorldCoupling>, 2> far_ends_{};
  std::array<std::optional<link::InProcessLink>, 2> links_{};
  std::optional<DatagramLink> guest_{};  // instead of the second link
  Duration dt_;
  MonotonicTime now_{};
  bool is_first_{true};
};

}  // namespace thimble::lab
