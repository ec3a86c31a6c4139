#include "daemon/world/fields/field_motion.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/world/free_place.hpp"

namespace thimble::world {
namespace {

// A way below this is none.
constexpr double kArrived_m = 1e-9;
// Far from every arm, near enough to compute with.
constexpr double kFar_m = 1e3;
// Shares of the field's step: what touches, and the longest slide.
constexpr double kTouchShare = 1e-3;
constexpr double kSlideShare = 0.125;
// Flatter is no face; turned by less than 25 degrees is the same face, curved.
constexpr double kLeastSlope = 0.5;
// Where the field hardly falls, its plane would be farther than a step from where it is told.
constexpr double kAnySlope = kTouchShare;
constexpr double kSameFaceCosine = 0.9;
constexpr int kHalvings = 7;
constexpr int kLifts = 4;

// The ghost on its way to one place of the hand.
class Run {
 public:
  Run(const DistanceField& field, Position3 from, Position3 target) noexcept
      : field_(field),
        touch_m_(kTouchShare * field.step_m()),
        ghost_(from),
        target_(target),
        here_(field.look(from)) {}

  // One leg. False: it has arrived, or no slide leads nearer.
  bool advance() noexcept {
    const Displacement3 wanted = target_ - ghost_;
    const double left_m = norm(wanted);
    if (left_m <= kArrived_m) return false;
    if (here_.distance_m > touch_m_) {
      const double safe_m = (here_.distance_m - touch_m_ / 2) / field_.steepest();
      go_to(safe_m >= left_m ? target_ : ghost_ + (safe_m / left_m) * wanted);
      return true;
    }
    const double into_m = std::max(0.0, -dot(here_.outward, wanted));
    const Displacement3 way = wanted + along<DisplacementTag>(here_.outward, into_m);
    is_at_rest_ = !slide(way, left_m);
    return !is_at_rest_;
  }

  [[nodiscard]] Position3 ghost() const noexcept { return ghost_; }

  void tell(const Material& surface, ProbeMotion& motion) const noexcept {
    if (here_.distance_m > touch_m_) return;
    const Displacement3 wanted = target_ - ghost_;
    if (here_.slope > kAnySlope && dot(here_.outward, wanted) < 0) {
      motion.planes.push_back(plane_at(ghost_, here_, surface));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const double way : {-1.0, 1.0}) tell_beside(axis, way, surface, motion);
    }
    const double left_m = norm(wanted);
    if (!motion.planes.empty() || !is_at_rest_ || left_m <= kArrived_m) return;
    // On a crease the gradient of its own cell may lead away: what holds it is across its way.
    const Direction3 across{-wanted.x / left_m, -wanted.y / left_m, -wanted.z / left_m};
    motion.planes.push_back(plane_at(ghost_, {0, across, 1}, surface));
  }

 private:
  // Where the field comes to 0, as it falls from `at` on.
  [[nodiscard]] static ContactPlane plane_at(Position3 at, const FieldLook& seen,
                                             const Material& surface) noexcept {
    const Direction3 normal = -seen.outward;
    return {.normal = normal,
            .offset_m = dot(normal, at) + seen.distance_m / seen.slope,
            .stiffness = surface.stiffness,
            .damping = surface.damping,
            .friction = surface.friction,
            .temperature_kelvin = surface.temperature_kelvin};
  }
  // In a dent other faces hold the hand, too: what a place a step beside sees, if it is another
  // face, leaves the ghost free, is as near to it as that, and the hand is past it.
  void tell_beside(std::size_t axis, double way, const Material& surface,
                   ProbeMotion& motion) const noexcept {
    Position3 at = ghost_;
    at[axis] += way * field_.step_m();
    const FieldLook seen = field_.look(at);
    if (!(seen.slope > kLeastSlope)) return;
    const ContactPlane plane = plane_at(at, seen, surface);
    const double gap_m = plane.offset_m - dot(plane.normal, ghost_);
    const bool is_past = dot(plane.normal, target_) > plane.offset_m;
    if (!is_past || gap_m < -touch_m_ || gap_m > field_.step_m()) return;
    for (const ContactPlane& told : motion.planes) {
      if (dot(told.normal, plane.normal) > kSameFaceCosine) return;
    }
    motion.planes.push_back(plane);
  }

  void go_to(Position3 at) noexcept {
    ghost_ = at;
    here_ = field_.look(at);
  }

  bool slide(Displacement3 way, double left_m) noexcept {
    const double length_m = norm(way);
    if (length_m <= kArrived_m) return false;
    double step_m = std::min(length_m, kSlideShare * field_.step_m());
    for (int halving = 0; halving < kHalvings; ++halving, step_m /= 2) {
      const Position3 at = lifted(ghost_ + (step_m / length_m) * way);
      const bool is_nearer = norm(target_ - at) < left_m - kArrived_m / 10;
      if (!is_nearer || !(field_.look(at).distance_m > 0)) continue;
      go_to(at);
      return true;
    }
    return false;
  }

  // Onto the surface, from what is a little below it.
  [[nodiscard]] Position3 lifted(Position3 at) const noexcept {
    for (int lift = 0; lift < kLifts; ++lift) {
      const FieldLook seen = field_.look(at);
      if (seen.distance_m >= touch_m_ / 4 || !(seen.slope > 0)) break;
      const double up_m = (touch_m_ / 2 - seen.distance_m) / std::max(seen.slope, 0.1);
      at = at + along<DisplacementTag>(seen.outward, std::min(up_m, field_.step_m()));
    }
    return at;
  }

  const DistanceField& field_;
  double touch_m_;
  Position3 ghost_;
  Position3 target_;
  FieldLook here_;
  bool is_at_rest_{false};  // touching, and no slide led nearer
};

}  // namespace

ProbeMotion move_ghost(const DistanceField& field, const Material& surface, Position3& ghost,
                       Position3 hand) noexcept {
  if (!is_finite(hand)) return {ghost, {}, false};
  Position3 target = hand;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    target[axis] = std::clamp(target[axis], -kFar_m, kFar_m);
  }
  Run run(field, ghost, target);
  for (int leg = 0; leg < kMaxFieldLegs && run.advance(); ++leg) {
  }
  ghost = run.ghost();
  ProbeMotion motion{ghost, {}, false};
  run.tell(surface, motion);
  return motion;
}

std::optional<Position3> find_place(const DistanceField& field, Position3 hand) noexcept {
  const double touch_m = kTouchShare * field.step_m();
  auto place = find_free_place(
      [&](Position3 at) { return (touch_m - field.look(at).distance_m) / field.steepest(); }, hand,
      field.step_m() / 8);
  if (place) (void)move_ghost(field, {}, *place, hand);
  return place;
}

}  // namespace thimble::world
