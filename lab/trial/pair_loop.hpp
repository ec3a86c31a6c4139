#pragma once

#include <array>
#include <memory>
#include <optional>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/arm_pair.hpp"
#include "daemon/link/in_process_link.hpp"
#include "hal/base/time.hpp"

namespace thimble::lab {

// Two arms that are each other's far end (coupling/arm_pair.hpp), each at the daemon's own link, in
// virtual time. From one arm to the other and back it takes both links' round trips.
//
// Thread: one. Ownership: the arm halves. Errors: none; the settings of the links must be valid.
class PairLoop {
 public:
  struct Arm {
    std::unique_ptr<coupling::ArmCoupling> half;
    coupling::PeerAnswer answer{coupling::PeerAnswer::Motion};
    link::ImpairmentSettings impairment{};
  };
  struct Seen {
    Position3 tip{};
    Velocity3 velocity{};  // as the servo has it
  };
  PairLoop(Arm first, Arm second, Duration dt = std::chrono::milliseconds(1));

  // One tick of both servos.
  std::array<coupling::ArmOutput, 2> tick(const std::array<Seen, 2>& seen);
  [[nodiscard]] Duration dt() const noexcept { return dt_; }

 private:
  void run_links_until(MonotonicTime end);

  std::array<Arm, 2> arms_;
  std::array<std::unique_ptr<coupling::WorldCoupling>, 2> far_ends_{};
  std::array<std::optional<link::InProcessLink>, 2> links_{};
  Duration dt_;
  MonotonicTime now_{};
  bool is_first_{true};
};

}  // namespace thimble::lab
