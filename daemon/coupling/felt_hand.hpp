#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/messages.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Where an eye has to see the hand, so that it sees what the hand feels. World frame.
struct FeltHand {
  Position3 hand{};
  Duration lag{};      // how long ago it was there
  Position3 ghost{};   // of the newest answer, valid when has_ghost
  PlaneList planes{};  // that hold it, as the newest answer has them
  bool has_ghost{false};
  world::Cell ghost_cell{};  // of that ghost, valid when has_ghost_cell
  bool has_ghost_cell{false};
  // ConstraintSet::pressure of the newest answer, N: to be shown beside the force, and none comes
  // of it. Valid when has_pressure, which it never is without planes.
  Force3 pressure{};
  bool has_pressure{false};
};

// Thesis 3.7: "the displayed position should correspond to the user's position of one time-delay
// prior, so as to match their haptic feedback". A wall is felt when the answer comes to the sample
// that first was past it; whoever draws the hand of now draws it deep inside by then.
//
//   usually         q(s), s the moment of the sample that the newest answer speaks of, out of the
//                   planes of that answer: what went past a wall before it was known is at the wall
//   while a wall    on that wall, too: it is computed at the arm, with no delay
//   presses
//   far end known   of schemes whose force comes from there: the slave's ghost, which is as old as
//                   the planes (what is at the far end may be past a face by a step before the
//                   world says so), or the slave of an answer without one
//   walls foretold  the ghost that the arm half moves itself, or q(t) out of the planes
//
// q = p + o, the hand in the world. A hand that no wall presses, but was past a plane all the same
// (it let go since, or a tap was shorter than the round trip and not felt), is shown kClear_m off
// it: what touches in the picture is felt, and what is felt touches. Decision 0417.
//
// "Felt" is ArmOutput::is_in_contact: a wall presses. A spring-damper and a wave are felt without
// one, as drag, as inertia, or as the spring to a slave that lags; that is no contact, and the
// picture shows none: it touches while the slave does, told by the same answer as the force
// (decision 0457). ThesisLiteralArm sets its frame in the tick in which a wall comes or goes, in
// binary32 of mm and with its defects: there the two may part for a tick.
//
// Thread: one servo thread. RT: reset(), observe() THIMBLE_RT, allocation-free. Errors: none; a tip
// that is not finite leaves all as it was.
class FeltHandObserver {
 public:
  static constexpr double kClear_m = 0.1e-3;  // ours: less than a picture shows

  THIMBLE_RT void reset(MonotonicTime now, Position3 hand) noexcept;
  // After a step of the arm half, with what went into it and what came out.
  THIMBLE_RT void observe(const ArmInput& input, const ArmOutput& output) noexcept;
  [[nodiscard]] const FeltHand& felt() const noexcept { return felt_; }

 private:
  struct Moment {
    MonotonicTime at{};
    Position3 hand{};
  };
  // At most one a millisecond: 2 s, more than lock-step at 500 ms needs.
  static constexpr std::size_t kMoments = 2048;
  static constexpr Duration kLeastSpacing = std::chrono::microseconds(900);

  void remember(MonotonicTime now, Position3 hand) noexcept;
  void learn(const ConstraintSet& set, const ArmInput& input) noexcept;
  void show_now(MonotonicTime now, Position3 hand) noexcept;
  void show_what_was_answered(MonotonicTime now, Position3 hand, bool is_pressing) noexcept;
  [[nodiscard]] Position3 out_of_planes(Position3 hand, double clear_m) const noexcept;
  [[nodiscard]] const Moment& oldest() const noexcept { return moments_[first_ % kMoments]; }

  std::array<Moment, kMoments> moments_{};
  std::uint64_t first_{0};  // of those kept: the one that is shown
  std::uint64_t next_{0};
  MonotonicTime answered_{};
  std::uint32_t restart_{0};
  FarEnd far_{};
  bool has_far_{false};
  FeltHand felt_{};
};

}  // namespace thimble::coupling
