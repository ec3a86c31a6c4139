#include "daemon/coupling/felt_hand.hpp"

#include <algorithm>

#include "daemon/coupling/far_end_port.hpp"
#include "daemon/coupling/told_planes.hpp"
#include "daemon/world/plane_projection.hpp"

namespace thimble::coupling {

void FeltHandObserver::reset(MonotonicTime now, Position3 hand) noexcept {
  first_ = next_ = 0;
  answered_ = now;
  has_far_ = false;
  felt_ = {};
  if (!is_finite(hand)) return;
  felt_.hand = hand;
  remember(now, hand);
}

void FeltHandObserver::observe(const ArmInput& input, const ArmOutput& output) noexcept {
  const Position3 hand = input.tip + output.offset;
  if (!is_finite(hand)) return;
  if (output.sample.restart != restart_) {
    restart_ = output.sample.restart;
    reset(input.now, hand);
  }
  remember(input.now, hand);
  if (input.fresh != nullptr) learn(*input.fresh, input);
  if (output.is_fading && !output.is_in_contact) {  // nobody answers, and nothing is felt
    felt_.planes.clear();
    felt_.has_ghost = felt_.has_ghost_cell = felt_.has_pressure = false;
    has_far_ = false;
    return show_now(input.now, hand);
  }
  if (output.sample.has_ghost) return show_now(input.now, output.sample.ghost);
  if (output.is_foretold) {
    return show_now(input.now, out_of_planes(hand, output.is_in_contact ? 0 : kClear_m));
  }
  if (has_far_) {
    felt_.lag = input.now - answered_;
    // The ghost of the slave is as old as the planes; the slave has moved on since.
    const Position3 slave = felt_.has_ghost ? felt_.ghost : far_.slave;
    felt_.hand = out_of_planes(slave, output.is_in_contact ? 0 : kClear_m);
    return;
  }
  show_what_was_answered(input.now, hand, output.is_in_contact);
}

void FeltHandObserver::remember(MonotonicTime now, Position3 hand) noexcept {
  const bool is_soon =
      next_ > first_ + 1 && now - moments_[(next_ - 2) % kMoments].at < kLeastSpacing;
  if (is_soon) --next_;  // the last one is replaced: the newest is always there
  moments_[next_ % kMoments] = {now, hand};
  ++next_;
  if (next_ - first_ > kMoments) ++first_;
}

void FeltHandObserver::learn(const ConstraintSet& set, const ArmInput& input) noexcept {
  std::uint64_t unsound = 0;
  felt_.planes = sound_planes(set.planes, unsound);
  felt_.has_ghost = set.has_ghost && is_finite(set.ghost);
  if (felt_.has_ghost) felt_.ghost = set.ghost;
  felt_.has_ghost_cell = felt_.has_ghost && set.has_ghost_cell;
  if (felt_.has_ghost_cell) felt_.ghost_cell = set.ghost_cell;
  const bool is_held = !felt_.planes.empty();  // without a face nothing presses
  felt_.has_pressure = is_held && set.has_pressure && is_finite(set.pressure);
  if (felt_.has_pressure) felt_.pressure = set.pressure;
  has_far_ = set.has_far && is_sound(set.far);
  if (has_far_) far_ = set.far;
  // A carriage that cannot tell which sample it answers knows how long an answer takes.
  const bool is_told = set.sampled_at > MonotonicTime{} && set.sampled_at <= input.now;
  const MonotonicTime said = is_told ? set.sampled_at : input.now - input.link.round_trip;
  answered_ = std::max(answered_, said);
}

void FeltHandObserver::show_now(MonotonicTime now, Position3 hand) noexcept {
  answered_ = std::max(answered_, now);
  first_ = next_ - 1;
  felt_.lag = {};
  felt_.hand = hand;
}

void FeltHandObserver::show_what_was_answered(MonotonicTime now, Position3 hand,
                                              bool is_pressing) noexcept {
  while (first_ + 1 < next_ && moments_[(first_ + 1) % kMoments].at <= answered_) ++first_;
  felt_.lag = now - oldest().at;
  felt_.hand = out_of_planes(oldest().hand, is_pressing ? 0 : kClear_m);
  if (!is_pressing) return;
  for (const ConstraintPlane& plane : felt_.planes) {
    const double short_m = -depth_m(plane, felt_.hand);
    if (short_m > 0 && depth_m(plane, hand) > 0) {
      felt_.hand = felt_.hand + along<DisplacementTag>(plane.normal, short_m);
    }
  }
}

Position3 FeltHandObserver::out_of_planes(Position3 hand, double clear_m) const noexcept {
  world::PastPlanes past;
  for (const ConstraintPlane& plane : felt_.planes) {
    past.push_back({plane.normal, depth_m(plane, hand) + clear_m});
  }
  return hand - world::project(past).past;
}

}  // namespace thimble::coupling
