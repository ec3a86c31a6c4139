#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "daemon/world/voxel_world.hpp"
#include "hal/base/result.hpp"
#include "lab/trial/coupling_case.hpp"
#include "lab/trial/finger.hpp"

// Where schemes are compared: a wall with an edge, a hand before it, and a network between.
namespace thimble::lab {

// The wall's face is at x = kWall_m, and it ends at y = 0: beyond, for y > 0, all is free. Ours; of
// cells of 3 mm, 32 a side.
inline constexpr double kWall_m = 0.015;
inline constexpr double kStageCell_m = 0.003;
// Where a hand is that has nothing to do with the edge, along y.
inline constexpr double kBeside_m = -0.02;

// Of the network as link::ImpairmentSettings has it: delay and jitter of the round trip, half of
// them in each direction, and the order is kept; loss of one message in one direction.
struct StageSettings {
  double delay_s{0};   // at least 0
  double jitter_s{0};  // the delay is uniform within delay ± jitter
  double loss{0};      // 0…1
  // The network is silent for kOutage_s once every kOutageEvery_s.
  bool has_outages{false};  // both directions
  // The front of the wall moves by a cell, there and back, every kMoveEvery_s.
  bool moves{false};
  std::uint64_t seed{1};
};
inline constexpr double kOutage_s = 0.2;
inline constexpr double kOutageEvery_s = 1.5;
inline constexpr double kMoveEvery_s = 0.7;

// What was felt in one tick.
struct Felt {
  double now_s{0};
  Position3 tip{};
  Velocity3 velocity{};
  Force3 force{};  // wish, before the limiter
  Displacement3 offset{};
  bool is_in_contact{false};
};

// One scheme in front of the wall, at 1 kHz. Before time 0 the hand has rested where it starts,
// long enough for the first answers and for what rises after them.
//
// Thread: one. Errors: create() hands on the scheme's refusal of the world.
class Stage {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Stage>> create(const CouplingCase& of,
                                                             const StageSettings& settings,
                                                             Position3 start);

  // One tick of the servo with the tip there; what was felt is also kept.
  const Felt& tick(Position3 tip, Velocity3 velocity);
  // One outage from now on, on top of those of the settings.
  void cut_network(double for_s) noexcept { silent_until_s_ = now_s_ + for_s; }

  [[nodiscard]] const std::vector<Felt>& history() const noexcept { return history_; }
  [[nodiscard]] double now_s() const noexcept { return now_s_; }
  [[nodiscard]] Duration dt() const noexcept { return loop_->dt(); }
  // Of both directions, since time 0.
  [[nodiscard]] double packets_per_s() const;
  [[nodiscard]] double bytes_per_s() const;

 private:
  Stage(const StageSettings& settings, std::unique_ptr<world::VoxelWorld> world) noexcept;
  void rest(Position3 start);
  void move_wall();
  [[nodiscard]] std::uint64_t packets() const;

  StageSettings settings_;
  std::unique_ptr<world::VoxelWorld> world_;
  std::unique_ptr<TrialLoop> loop_;
  std::vector<Felt> history_;
  MonotonicTime began_{};
  std::uint64_t packets_before_{0};
  std::uint64_t bytes_before_{0};
  double now_s_{0};
  double silent_until_s_{0};
  bool is_forward_{false};
};

}  // namespace thimble::lab
