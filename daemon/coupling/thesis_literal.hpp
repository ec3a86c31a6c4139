#pragma once

#include <array>
#include <cstdint>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/constraint_age.hpp"
#include "daemon/coupling/messages.hpp"

namespace thimble::coupling {

// What the printed client shares between its network loop and its servo callback. Binary32,
// mm. Direction bits (teleop.md 6): 0x01 x < plane, 0x02 x > plane, 0x04 y <, 0x08 y >,
// 0x10 z <, 0x20 z >. A value whose bits are both clear is never read.
struct ThesisConstraint {
  std::array<float, 3> plane_mm{};
  std::uint8_t directions{0};
};

struct ThesisTick {
  std::array<float, 3> force_newton{};
  std::array<float, 3> adjusted_mm{};  // what the network loop would send
  std::array<float, 3> offset_mm{};    // after the tick
};

// The servo callback of thesis appendix A (voxel_client.c, servoLoopCallback()), bit for bit: its
// order of float operations and its defects (docs/thesis-defects.md; teleop.md 7: 1, 9, 11 to 15).
// To be shown and compared with, not to be used. Of each axis by itself, in a tick:
//
//   q = p + o
//   o ← c − p + H        a bit that was clear in the tick before is set, and q is past c by more
//                        than H: q > c + H ("<"), q + H < c (">"); +H of both is defect 1
//   q ← p + o            what is sent
//   F = K·(c − q) − B·v + k_o·o      where q is past c: q > c ("<"), q < c (">"); else 0 and,
//   o ← o − sign(o)·H/2              each tenth tick, where |o| > 4·H
//
// p, v  tip, mm, mm/s, arm's frame     c  plane on that axis, mm, world's frame; its bits say of
// o     coordinate offset, mm             which side, and are the newest reply's
// q     hand in the world, mm          K  stiffness, 0.8 N/mm     k_o  coordinate spring, 0.05 N/mm
// F     on the hand, N                 B  0.01 N·s/mm: the listing says no unit
// H     hysteresis, 0.5 mm
//
// Its ticks are 1 ms. Unlike GhostPointArm it pulls where B·v or k_o·o outweighs K·(c − q).
//
// Thread: one. RT: step() THIMBLE_RT.
// Errors: none; what the printed callback does with NaN, this does.
class ThesisLiteralServo {
 public:
  // The first tick erases `constraint`, as the printed one does (defect 15).
  THIMBLE_RT ThesisTick step(const std::array<float, 3>& position_mm,
                             const std::array<float, 3>& velocity_mm_per_s,
                             ThesisConstraint& constraint) noexcept;

 private:
  std::array<float, 3> offset_mm_{};
  std::uint8_t old_directions_{0};
  std::uint8_t ticks_modulo_10_{0};
  bool is_first_{true};
};

// The printed callback as a coupling: SI and double outside, mm and float inside. Only the
// age of constraints is added (a safety row): the force fades and then nothing is left to feel.
// The frame is not frozen meanwhile, only flagged: decision 0054.
//
// Thread: one servo thread. RT: reset(), step() THIMBLE_RT.
// Frames: tip in the arm's base frame; planes and what is sent in the world's, axes parallel.
// Errors: planes that are not axis-aligned, or further than 1 km, are not felt; of two on one axis
//         the first is. A tip that is not finite goes through the printed sums: NaN is past no
//         plane, so nothing is felt; a force that is not finite latches a fault behind it.
class ThesisLiteralArm final : public ArmCoupling {
 public:
  explicit ThesisLiteralArm(const ConstraintAgeSettings& age = {}) noexcept : age_(age) {}

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;

  void count_contacts(const ThesisTick& tick, ArmOutput& output) noexcept;

  ConstraintAge age_;
  ThesisLiteralServo servo_{};
  ThesisConstraint constraint_{};
  std::uint64_t sequence_{0};
  std::uint64_t applied_reply_{0};
  std::uint32_t restarts_{0};  // calls of reset()
  std::uint8_t pressing_{0};   // direction bits
};

}  // namespace thimble::coupling
