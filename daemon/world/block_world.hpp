#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "daemon/world/block_push.hpp"
#include "daemon/world/block_scene.hpp"
#include "daemon/world/world.hpp"

namespace thimble::world {

// A block that hands push about a room: what a hand does to it, the others feel (thesis 5.2, two
// fingers grasp; 5.3.4, several users in one world). It does not turn. Its faces may rub, and
// something may pull it: two fingers that squeeze it then carry it crosswise, and lift it.
//
// With x the hand's depth behind the face that holds its ghost, K the stiffness kPush and B the
// drag, the block gives way by B·dx/dt = −K·x, which is solved exactly for the probe's own step:
//
//   moved = x·(1 − e^(−K·dt/B))      [m]
//
// likewise along the face, and with a weight (push_block()).
//
// Each probe moves it by its own time, so that nothing depends on which probe is served first
// but the rounding; what two hands do adds up: against each other it stands, from one side it goes
// twice as fast. Of a weight each of n probes brings 1/n, so that in the time that all of them tell
// it counts once; without probes time stands still. Between two that are served in turn a grasp is
// held by 2·B/(K·dt)·tanh(K·dt/(2·B)) of what it should: 98.7 % at 50 Hz and B of 40 N·s/m. It
// stops at the walls of the room, which are smooth. A ghost in its way is taken along. A probe that
// is not served any more pushes no more.
//
// What the hand is told of friction (ContactPlane::friction): the share of its push that a face
// takes along itself just now, at most the coefficient, so that it feels what it drags and no more;
// none where there is none.
//
// Thread: one, the world's. Not RT; move_probe() neither allocates nor blocks.
// Mirrored hands give a mirrored block to the bit.
class BlockWorld final : public World {
 public:
  // Ours: the wall of the thesis, 800 N/m.
  static constexpr double kPush_newton_per_m = 800;

  // InvalidArgument unless all is finite; edge, room and drag above zero, and the edge below the
  // room's; and friction from 0 to 1.
  [[nodiscard]] static Result<BlockWorld> create(const BlockScene& scene);

  [[nodiscard]] const WorldInfo& info() const noexcept override { return info_; }
  [[nodiscard]] bool has_faces_across_the_axes_only() const noexcept override { return true; }
  [[nodiscard]] std::optional<Position3> block_center() const noexcept override { return center_; }
  [[nodiscard]] Result<ProbeId> add_probe(Position3 hand) override;
  void remove_probe(ProbeId probe) noexcept override;
  ProbeMotion move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept override;

 private:
  using Signs = std::array<int, 3>;
  // A face that a hand is behind.
  struct Grip {
    std::size_t axis{0};
    int sign{0};           // of the way into the block
    Displacement3 foot{};  // where the hand sticks, from the block's center; along the face
    double friction{0};    // what it is told
  };
  struct Probe {
    ProbeId id{};
    Position3 ghost{};
    std::optional<Grip> grip{};
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
  void give_way(Probe& probe, const Held& held, Position3 hand, Duration dt) noexcept;
  [[nodiscard]] double told_friction(const std::optional<Grip>& grip) const noexcept;
  void go_to(Position3 center) noexcept;

  WorldInfo info_;
  double half_room_m_;
  double half_m_;
  BlockOil oil_;
  Force3 weight_;
  Position3 center_{};
  std::array<std::optional<Probe>, kMaxProbes> probes_{};
  std::uint32_t last_id_{0};
};

}  // namespace thimble::world
