#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "daemon/coupling/world_coupling.hpp"

namespace thimble::coupling {

// Real teleoperation (thesis 5.3.5): the far end of an arm is another arm instead of a world. Each
// of the two has its own link; where the links meet each is answered with what the other one said
// last. The arm halves are those of the schemes, unchanged.
//
//   Motion  both arms; SpringDamperArm on both sides, or WaveArm on both sides
//           F_A = K_c·(x_B(t−T) − x_A) − B·v_A      and the same with A and B exchanged
//           w_A(t) = u_B(t−T),  w_B(t) = u_A(t−T)   waves as in wave_arm.hpp: a rod between hands
//   Touch   for a GhostPointArm whose slave is a SpringDamperArm that is told Motion: thesis 3.7,
//           extended with force. What stops the slave is told as a plane, which the master feels
//           locally, at a frame that is shifted by what it moved on meanwhile:
//           f = pull_B − B·v_B     n = f/|f|     plane n·q <= n·x_B, of stiffness K_c
//           from |f| > kTouch and a slave that rested for kNoTurn, until the master is on its free
//           side, or the slave has run on for kNoBounce with less to stop it. Both are pressed by
//           K_c·x, with x the depth of the master behind the plane.
//
// x position, m; v velocity, m/s; K_c, B as each arm has them; pull_B = K_c·(x_A − x_B), N, as the
// slave's arm half has it. T one way: half of both links' round trips. Frame: world, which both
// arms share. Sources: thesis 5.3.5, 3.4, 3.5, 3.7; Lee and Spong, Nuño (b), Niemeyer and Slotine
// (c) (docs/references.md; teleop.md 2); the plane of a force is ours (decision 0445).
//
// Stable as the schemes are: (b) for 4·B_A·B_B > (T₁+T₂)²·K_A·K_B, which both keep since neither is
// stiffer than the other (FarEnd::tool) and each than B/(1.05·its round trip); (c) for any delay,
// every channel being a WaveInlet and a WaveOutlet; Touch as the ghost point.
//
// Positions: (b) and Touch coincide at rest where nothing presses. (c) moves arms alike from where
// they were when the later one joined: a gap between them then stays.
//
// An arm that is silent, or away, is told to nobody: to the other one its world is silent, whose
// force fades. An arm that starts again starts a new session of the other.
//
// Thread: one, that of the links. Not RT; answer() neither allocates nor blocks.
// Ownership: halves share what they exchange; they may go in any order, and before the pair.
// Errors: open() of a half refuses a hand or waves that are not finite (InvalidArgument) and an arm
//         that has a guard between both ends (Unsupported). Such a sample, or one that was
//         overtaken, is answered with the last set, its number included.
enum class PeerAnswer : std::uint8_t { Motion, Touch };

class ArmPair {
 public:
  enum class Side : std::uint8_t { First, Second };
  // Sessions are numbered from `first_session`.
  explicit ArmPair(std::uint32_t first_session);
  // What the link of one of the arms is answered by. The newest that was opened is the arm's; each
  // time that one is opened is another start of its arm.
  [[nodiscard]] std::unique_ptr<WorldCoupling> make_half(Side side, PeerAnswer answer) const;

 private:
  struct Meeting;
  class Half;
  std::shared_ptr<Meeting> meeting_;
};

// Ours: above an arm's own friction and what its mass takes in a person's motion.
inline constexpr double kTouch_newton = 1.0;
// Ours: a slave that still moves is not stopped, it is on its way.
inline constexpr double kStopped_m_per_s = 0.03;
// Ours: one that swings rests for a shorter time where it turns.
inline constexpr Duration kNoTurn = std::chrono::milliseconds(20);
// Ours: a slave that was drawn far in springs back and returns within half of this.
inline constexpr Duration kNoBounce = std::chrono::milliseconds(100);

}  // namespace thimble::coupling
