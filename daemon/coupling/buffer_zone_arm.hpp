#pragma once

#include <cstdint>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/far_end_port.hpp"
#include "daemon/coupling/messages.hpp"
#include "daemon/world/ghost_slide.hpp"

namespace thimble::coupling {

// Thesis 3.6 says no numbers; the wall is the ghost point's, and is rendered here as that one is.
struct BufferZoneSettings {
  ToolProperties tool{.stiffness = {800}, .damping = {5}};
  ConstraintAgeSettings age{};
};

// The arm half of teleoperation with buffer zones (thesis 3.6): the world half (BufferZoneWorld)
// tells of faces before the hand is there, and they are rendered here, without any delay and
// without displacing the hand.
//
//   F = −Σ n·max(0, K·x + B·(n·v)),  x = n·q − d > 0        (wall_penalty.hpp)
//
// F    on the hand, N                    K, B  wall: N/m, N·s/m
// q, v the tip, m and m/s                n, d  of the planes below
//
// Which planes: where the answer names faces (figure 3-4), all of them, up to two an axis; the hand
// that goes round an edge feels the face go on until it is told otherwise. Where it names occupied
// cells (figure 3-5b), a ghost is moved after the tip through what they leave free, as the world
// moves its own (world/ghost_slide.hpp); the planes are the faces that hold it. So a cell
// constrains along the face that the hand came through and along no other, and corners and edges
// end where they do.
//
// As long as the hand moves no faster than v_max and answers take no longer than D_max, with
//
//   d_buf >= v_max·(D_max + Ts)        d_buf  of the zone, m; Ts period of the servo, s
//
// every cell that the ghost meets is known, and the force is that of no delay, bit for bit
// (teleop.md 2(d)). Beyond it a wall is found late: the hand is x = v·D − d_buf deep, and the force
// a step to K·x, which gives the hand up to ½·K·x²; the limiter bounds the step and its rise. That
// is the scheme's, not mended here.
//
// The ghost goes on by itself from where the world's was first. It goes back there, and from there
// straight at the tip, when it got beyond what is known (the hand was too fast) or into matter, and
// when the world says that the two have parted (ConstraintSet::is_astray: cells that changed).
// Matter around the ghost is told by planes, which sweep (docs/ghost-motion.md).
//
// What the hand feels of a silent world, an outage, a restart: FarEndPort; until then the last
// zone holds.
// Thread: one servo thread. RT: reset(), step() THIMBLE_RT; a step is bounded by the
// cells between ghost and tip.
// Frames: base frame of the arm, which is the world's, axes parallel; no offset.
// Errors: FarEndPort's; a zone that cannot be is as good as no reply, a plane as none.
class BufferZoneArm final : public ArmCoupling {
 public:
  explicit BufferZoneArm(const BufferZoneSettings& settings = {}) noexcept;

  [[nodiscard]] const FarEndPort& port() const noexcept { return port_; }
  // Since construction: how often the ghost went back to the world's.
  [[nodiscard]] std::uint64_t corrections() const noexcept { return corrections_; }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;

  void forget() noexcept;
  void learn(const ConstraintSet& said) noexcept;
  // The ghost after the tip; the planes are those that hold it.
  void follow(Position3 tip) noexcept;

  ToolProperties tool_;
  FarEndPort port_;
  PlaneList planes_{};
  world::NearCells near_{};
  world::GhostPoint ghost_{};
  bool has_ghost_{false};
  std::uint64_t seated_at_{0};  // the sample before which the ghost was not its own
  std::uint64_t corrections_{0};
};

}  // namespace thimble::coupling
