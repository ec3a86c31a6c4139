#include "daemon/coupling/composite_arm.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::coupling {
namespace {

constexpr double kAlongAxis = 1 - 1e-9;
constexpr std::uint64_t kRemembered = 64;  // answers, by HandSample::applied_before

bool is_in_cell(const world::CellLattice& lattice, const world::GhostPoint& ghost,
                bool is_plane) noexcept {
  if (!lattice.is_inside(ghost.cell) || !std::isfinite(ghost.position.z)) return false;
  for (std::size_t axis = 0; axis < (is_plane ? 2U : 3U); ++axis) {
    const double at_m = ghost.position[axis];
    if (!(at_m >= lattice.face_m(axis, ghost.cell[axis]))) return false;
    if (!(at_m <= lattice.face_m(axis, ghost.cell[axis] + 1))) return false;
  }
  return true;
}

}  // namespace

CompositeArm::CompositeArm(const GhostPointSettings& settings) noexcept : ghost_point_(settings) {}

void CompositeArm::restart(MonotonicTime now, Position3 tip) noexcept {
  ghost_point_.reset(now, tip);
  // The map stays: the world knows what was told in this session, and does not tell it again.
  has_ghost_ = has_told_ = false;
}

ArmOutput CompositeArm::advance(const ArmInput& input) noexcept {
  if (!is_finite(input.tip) || !is_finite(input.tip_velocity)) {
    return ghost_point_.step_as_told(input, nullptr);
  }
  if (input.fresh != nullptr) learn(*input.fresh);
  const Position3 hand = input.tip + ghost_point_.offset();
  if (has_ghost_ && !follow(hand)) {
    has_ghost_ = false;
    has_told_ = true;
  }
  const ConstraintSet* said = has_ghost_ || has_told_ ? &felt_ : nullptr;
  if (!has_ghost_) {
    ++counters_.trusted;
    if (has_told_) felt_.planes = told_;
    has_told_ = false;
  }
  ArmOutput output = ghost_point_.step_as_told(input, said);
  sequence_ = output.sample.sequence;
  output.sample.ghost = ghost_.position;
  output.sample.has_ghost = has_ghost_;
  output.sample.epoch = has_ghost_ ? epoch_ : 0;
  // The world's ghost is to go after the same place as this one did, not after where the frame has
  // moved since.
  if (has_ghost_) output.sample.hand = hand;
  output.sample.applied_reply = applied_reply_;
  output.sample.applied_before = applied_before_;
  return output;
}

void CompositeArm::learn(const ConstraintSet& said) noexcept {
  note_applied(said);
  felt_.sequence = said.sequence;
  felt_.session = said.session;
  told_.clear();
  for (const ConstraintPlane& plane : said.planes) told_.push_back(plane);
  has_told_ = true;
  if (!take_map(said) || said.is_embedded || !is_explained(said)) {
    has_ghost_ = false;
    return;
  }
  // What the world says of a sample from before the ghost was put right is no news.
  const bool is_astray = said.is_astray && said.answers > seated_at_;
  if (has_ghost_ && !is_astray && !mirror_.is_occupied(ghost_.cell)) return;
  if (has_ghost_) ++counters_.corrections;
  ghost_ = {said.ghost, said.map.ghost_cell};
  seated_at_ = sequence_;
  has_ghost_ = true;
}

void CompositeArm::note_applied(const ConstraintSet& said) noexcept {
  const bool is_new_session = !has_session_ || said.session != session_;
  if (is_new_session || said.sequence < applied_reply_) {
    applied_before_ = 0;
    has_ghost_ = false;
    (void)mirror_.begin(said.map.lattice);
  } else if (said.sequence > applied_reply_) {
    const std::uint64_t later = said.sequence - applied_reply_;
    applied_before_ = later < kRemembered ? applied_before_ << later : 0;
    if (later <= kRemembered) applied_before_ |= std::uint64_t{1} << (later - 1);
  }
  has_session_ = true;
  session_ = said.session;
  applied_reply_ = said.sequence;
}

// Whether the answer's ghost is in a free cell that is known.
bool CompositeArm::take_map(const ConstraintSet& said) noexcept {
  if (!said.has_map || !said.has_ghost) return false;
  if (said.map.lattice != mirror_.lattice() || said.map.epoch != epoch_) {
    has_ghost_ = false;  // its cell is of other cells
    epoch_ = said.map.epoch;
    if (!mirror_.begin(said.map.lattice)) return false;
  }
  is_plane_ = said.map.is_plane;
  if (is_plane_ && said.map.lattice.cells[2] != 1) return false;
  for (const world::OccupancyBlock& block : said.map.blocks) (void)mirror_.learn(block);
  const world::GhostPoint ghost{said.ghost, said.map.ghost_cell};
  return is_in_cell(mirror_.lattice(), ghost, is_plane_) && mirror_.is_known(ghost.cell) &&
         !mirror_.is_occupied(ghost.cell);
}

bool CompositeArm::is_explained(const ConstraintSet& said) const noexcept {
  return std::all_of(said.planes.begin(), said.planes.end(), [&](const ConstraintPlane& plane) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (std::abs(plane.normal[axis]) < kAlongAxis) continue;
      world::Cell behind = said.map.ghost_cell;
      behind[axis] += plane.normal[axis] > 0 ? 1 : -1;
      return mirror_.is_known(behind) && mirror_.is_occupied(behind);
    }
    return false;
  });
}

bool CompositeArm::follow(Position3 hand) noexcept {
  Position3 target = hand;
  if (is_plane_) {
    target.z = 0;
    ghost_.position.z = 0;
  }
  const world::Slide slide = slide_ghost(mirror_, ghost_, target);
  if (!mirror_.is_known(slide.ghost.cell)) return false;
  ghost_ = slide.ghost;
  if (is_plane_) ghost_.position.z = hand.z;
  felt_.planes.clear();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (slide.held[axis] == 0) continue;
    ConstraintPlane plane;
    plane.normal[axis] = slide.held[axis];
    plane.offset_m = slide.held[axis] * ghost_.position[axis];
    felt_.planes.push_back(plane);
  }
  return true;
}

}  // namespace thimble::coupling
