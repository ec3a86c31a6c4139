#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/deadband.hpp"
#include "daemon/link/in_process_link.hpp"
#include "hal/base/time.hpp"

namespace thimble::lab {

// Arm half, world half and the daemon's own link between them, in virtual time: what an arm's servo
// and the net plane do with them, without arm, bus and limiter. Delay, jitter, loss and order are
// the link's.
//
// Thread: one. Ownership: both halves; the world of `world_half` must outlive it.
// Errors: none; the settings of the link must be valid.
class TrialLoop {
 public:
  struct Settings {
    Duration dt{std::chrono::milliseconds(1)};  // of the servo
    link::SendMode mode{link::SendMode::Streamed};
    link::ImpairmentSettings impairment{};
    double deadband_m{0};  // 0: every sample is sent
  };
  TrialLoop(std::unique_ptr<coupling::ArmCoupling> arm_half,
            std::unique_ptr<coupling::WorldCoupling> world_half, const Settings& settings);

  // One tick of the servo, `dt` after the one before. Tip: base frame, m; its velocity as the servo
  // has it.
  coupling::ArmOutput tick(Position3 tip, Velocity3 velocity);
  // A network that is down loses what is sent and what would arrive.
  void set_network(bool is_up) noexcept { is_up_ = is_up; }

  [[nodiscard]] MonotonicTime now() const noexcept { return now_; }
  [[nodiscard]] Duration dt() const noexcept { return settings_.dt; }
  [[nodiscard]] std::uint64_t samples_sent() const noexcept { return samples_sent_; }
  // Of the samples sent and the answers taken, as datagrams of ours in the clear.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] std::uint64_t samples_withheld() const noexcept { return samples_withheld_; }
  [[nodiscard]] link::LinkStatus status() const { return link_.status(); }

 private:
  struct Told {
    std::uint64_t sequence{0};
    Position3 hand{};
    MonotonicTime sent_at{};
  };
  void send(const coupling::HandSample& sample);
  void note_answer(const coupling::ConstraintSet& reply) noexcept;

  Settings settings_;
  std::unique_ptr<coupling::ArmCoupling> arm_half_;
  std::unique_ptr<coupling::WorldCoupling> world_half_;
  link::InProcessLink link_;
  MonotonicTime now_{};
  link::Deadband deadband_;
  std::vector<Told> told_;  // by sequence, modulo its size
  std::uint64_t samples_sent_{0};
  std::uint64_t bytes_{0};
  std::uint64_t samples_withheld_{0};
  bool is_first_{true};
  bool is_up_{true};
};

}  // namespace thimble::lab
