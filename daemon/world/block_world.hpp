#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "daemon/world/block_scene.hpp"
#include "daemon/world/world.hpp"

namespace thimble::world {

// A block that hands push about a room: what a hand does to it, the others feel (thesis 5.2, two
// fingers grasp; 5.3.4, several users in one world). It does not turn, and faces have no friction.
//
// With x the hand's depth behind the face that holds its ghost, K the stiffness kPush and B the
// drag, the block gives way by B·dx/dt = −K·x, which is solved exactly for the probe's own step:
//
//   moved = x·(1 − e^(−K·dt/B))      [m]
//
// Each probe moves it by its own time, so that nothing depends on which probe is served first
// but the rounding; what two hands do adds up: against each other it stands, from one side it goes
// twice as fast. It stops at the walls of the room. A ghost in its way is taken along. A probe that
// is not served any more pushes no more.
//
// Thread: one, the world's. Not RT; move_probe() neither allocates nor blocks.
// Mirrored hands give a mirrored block to the bit.
class BlockWorld final : public World {
 public:
  // Ours: the wall of the thesis, 800 N/m.
  static constexpr double kPush_newton_per_m = 800;

  // InvalidArgument unless all is finite and above zero, and the edge below the room's.
  [[nodiscard]] static Result<BlockWorld> create(const BlockScene& scene);

  [[nodiscard]] const WorldInfo& info() const noexcept override { return info_; }
  [[nodiscard]] bool has_faces_across_the_axes_only() const noexcept override { return true; }
  [[nodiscard]] std::optional<Position3> block_center() const noexcept override { return center_; }
  [[nodiscard]] Result<ProbeId> add_probe(Position3 hand) override;
  void remove_probe(ProbeId probe) noexcept override;
  ProbeMotion move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept override;

 private:
  using Signs = std::array<int, 3>;
  struct Probe {
    ProbeId id{};
    Position3 ghost{};
  };
  // What stops a ghost, by axis: -1, 0, 1.
  struct Held {
    Signs by_room{};
    Signs by_block{};
  };
  explicit BlockWorld(const BlockScene& scene);
  [[nodiscard]] std::optional<Probe>* find(ProbeId id) noexcept;
  [[nodiscard]] double low_m(std::size_t axis) const noexcept { return center_[axis] - half_m_; }
  [[nodiscard]] double high_m(std::size_t axis) const noexcept { return center_[axis] + half_m_; }
  [[nodiscard]] bool is_in_block(Position3 p) const noexcept;
  [[nodiscard]] Position3 out_of_block(Position3 p) const noexcept;
  Held slide(Position3& ghost, Position3 hand) const noexcept;
  void give_way(const Held& held, Position3 hand, Duration dt) noexcept;
  void take_along(std::size_t axis, double moved_m) noexcept;

  WorldInfo info_;
  double half_room_m_;
  double half_m_;
  double drag_newton_s_per_m_;
  Position3 center_{};
  std::array<std::optional<Probe>, kMaxProbes> probes_{};
  std::uint32_t last_id_{0};
};

}  // namespace thimble::world
