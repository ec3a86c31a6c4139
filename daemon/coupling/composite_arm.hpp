#pragma once

#include <cstdint>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/coupling/messages.hpp"
#include "daemon/world/ghost_slide.hpp"
#include "daemon/world/occupancy_mirror.hpp"

namespace thimble::coupling {

// For the status and for tests; since construction.
struct CompositeCounters {
  std::uint64_t corrections{0};  // the ghost went back to the world's
  std::uint64_t trusted{0};      // steps in which the world's planes were felt, not the map's
  bool operator==(const CompositeCounters&) const = default;
};

// The arm half of our own scheme: the ghost point (thesis 3.7), to which the cells are known that
// the hand may meet. The world half (CompositeWorld) tells of them, those near the hand first, and
// again when they change: a world of 64 cells an edge is known as a whole after 128 answers.
//
// Every tick a ghost of its own goes after q = p + o through what is known, as the world moves its
// own (world/ghost_slide.hpp); the faces that hold it are given to the ghost point at once. So
//
//   known cells       are felt with no delay at all, at full stiffness, where they are
//   cells that change are felt D/2 late, and the frame gives way: GhostPointArm, its equations
//   unknown cells     are felt by the planes of the answer: the ghost point, streamed
//
// p, o, q  tip, offset of the frame, hand in the world, m; D from sample to answer, there and back,
// s.
//
// The world's planes are felt while the map does not explain them: a plane of the answer is
// explained by an occupied cell behind it that is known. The ghost goes back to the world's, and
// from there straight at the hand, when the two have parted (ConstraintSet::is_astray) or its cell
// was filled. Cells that were all replaced at once (MapNews::epoch) are unknown ones from then on.
//
// A silent world: as the ghost point's, whatever is known (ConstraintAge).
// Thread: one servo thread; counters() too. RT: reset(), step() THIMBLE_RT; a step is bounded by
// the cells between ghost and hand. Frames: GhostPointArm's. Errors: a map that cannot be is as
// good as none; GhostPointArm's.
class CompositeArm final : public ArmCoupling {
 public:
  explicit CompositeArm(const GhostPointSettings& settings) noexcept;

  [[nodiscard]] const GhostPointCounters& ghost_point() const noexcept {
    return ghost_point_.counters();
  }
  [[nodiscard]] const CompositeCounters& counters() const noexcept { return counters_; }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;

  void learn(const ConstraintSet& said) noexcept;
  [[nodiscard]] bool take_map(const ConstraintSet& said) noexcept;
  [[nodiscard]] bool is_explained(const ConstraintSet& said) const noexcept;
  void note_applied(const ConstraintSet& said) noexcept;
  // The ghost after the hand; false: it came to where nothing is known.
  [[nodiscard]] bool follow(Position3 hand) noexcept;

  GhostPointArm ghost_point_;
  world::OccupancyMirror mirror_{};
  world::GhostPoint ghost_{};
  PlaneList told_{};      // of the newest answer
  ConstraintSet felt_{};  // the planes that hold the ghost now, else those
  bool has_ghost_{false};
  bool is_plane_{false};
  bool has_session_{false};
  bool has_told_{false};  // and its planes are not yet felt
  std::uint32_t session_{0};
  std::uint64_t epoch_{0};  // of the cells of the map
  std::uint64_t applied_reply_{0};
  std::uint64_t applied_before_{0};
  std::uint64_t sequence_{0};   // of the newest sample
  std::uint64_t seated_at_{0};  // the sample before which the ghost was not its own
  CompositeCounters counters_{};
};

}  // namespace thimble::coupling
