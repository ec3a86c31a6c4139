#include "daemon/world/shapes/shape_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "daemon/world/free_place.hpp"
#include "daemon/world/plane_projection.hpp"
#include "hal/rt/static_vector.hpp"

namespace thimble::world {
namespace {

// A way below this is none.
constexpr double kArrived_m = 1e-10;
// Far from every arm, near enough to compute with.
constexpr double kFar_m = 1e3;
// Of a search for a free place.
constexpr double kSearchStep_m = 0.001;

struct Touch {
  std::size_t shape{0};
  Outside outside{};
};

// The ghost on its way to one place of the hand.
class Run {
 public:
  Run(std::span<const PlacedShape> shapes, Position3 from, Position3 target) noexcept
      : shapes_(shapes), ghost_(from), target_(target) {
    look_around();
  }

  // One leg. False: it has arrived where no way leads nearer.
  bool advance() noexcept {
    const Displacement3 way = target_ - ghost_ - held_.past;
    if (norm(way) <= kArrived_m || !held_.has_place) return false;
    ghost_ = ghost_ + share_of(way) * way;
    look_around();
    return true;
  }

  [[nodiscard]] Position3 ghost() const noexcept { return ghost_; }

  // What holds the ghost where it is.
  void tell(ProbeMotion& motion) const noexcept {
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      if (!(held_.share[i] > 0)) continue;
      const auto& [shape, outside] = touches_[i];
      const Material& surface = shapes_[shape].surface();
      const Direction3 normal = -outside.outward;
      motion.planes.push_back({.normal = normal,
                               .offset_m = dot(normal, ghost_) + outside.distance_m,
                               .stiffness = surface.stiffness,
                               .damping = surface.damping,
                               .friction = surface.friction,
                               .temperature_kelvin = surface.temperature_kelvin});
    }
  }

 private:
  // What is touched, and what of it is in the way. What rounding has pushed in is lifted out first.
  void look_around() noexcept {
    touches_.clear();
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      Outside outside = shapes_[i].look(ghost_);
      if (outside.distance_m < kTouch_m / 4) {
        ghost_ =
            ghost_ + along<DisplacementTag>(outside.outward, kTouch_m / 2 - outside.distance_m);
        outside = shapes_[i].look(ghost_);
      }
      around_[i] = outside;
      if (outside.distance_m <= kTouch_m) touches_.push_back({i, outside});
    }
    PastPlanes planes;
    for (const Touch& touch : touches_) {
      planes.push_back({-touch.outside.outward, -dot(touch.outside.outward, target_ - ghost_)});
    }
    held_ = project(planes);
  }

  // The part of a way that passes no surface.
  [[nodiscard]] double share_of(Displacement3 way) const noexcept {
    double share = 1;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      const double fall_m = -dot(around_[i].outward, way);
      if (fall_m <= 2 * kPlaneTolerance_m) continue;
      const double room_m = std::max(0.0, around_[i].distance_m - kTouch_m / 2);
      share = std::min(share, room_m / fall_m);
    }
    return share;
  }

  std::span<const PlacedShape> shapes_;
  Position3 ghost_;
  Position3 target_;
  std::array<Outside, kMaxShapes> around_{};
  rt::StaticVector<Touch, kMaxContactPlanes> touches_{};
  PlaneProjection held_{};
};

double depth_inside_m(std::span<const PlacedShape> shapes, Position3 at) noexcept {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const PlacedShape& shape : shapes)
    nearest_m = std::min(nearest_m, shape.look(at).distance_m);
  return -nearest_m;
}

}  // namespace

ProbeMotion move_ghost(std::span<const PlacedShape> shapes, Position3& ghost,
                       Position3 hand) noexcept {
  if (!is_finite(hand)) return {ghost, {}, false};
  Position3 target = hand;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    target[axis] = std::clamp(target[axis], -kFar_m, kFar_m);
  }
  Run run(shapes.first(std::min(shapes.size(), kMaxShapes)), ghost, target);
  for (int leg = 0; leg < kMaxShapeLegs && run.advance(); ++leg) {
  }
  ghost = run.ghost();
  ProbeMotion motion{ghost, {}, false};
  run.tell(motion);
  return motion;
}

std::optional<Position3> find_place(std::span<const PlacedShape> shapes, Position3 hand) noexcept {
  if (depth_inside_m(shapes, hand) <= 0) return hand;
  auto best =
      find_free_place([shapes](Position3 at) { return depth_inside_m(shapes, at) + kTouch_m; },
                      hand, kSearchStep_m);
  if (best) (void)move_ghost(shapes, *best, hand);
  return best;
}

}  // namespace thimble::world
