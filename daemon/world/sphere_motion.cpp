#include "daemon/world/sphere_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace thimble::world {
namespace {

constexpr double kNegligible_rad = 1e-12;
// A leg that ends where a surface lets go ends this far beyond, lest rounding holds it.
constexpr double kBeyond_rad = 1e-9;
// Below this share of the radius the ring is the one point where a resting ball touches the floor.
constexpr double kLeastRing = 1e-7;
// Far from every arm, near enough to compute with.
constexpr double kFar_m = 1e3;

enum class Hold : std::uint8_t { None, Floor, Sphere, Both };

[[nodiscard]] Direction3 direction_of(Displacement3 v, double length_m) noexcept {
  return {v.x / length_m, v.y / length_m, v.z / length_m};
}

[[nodiscard]] double ring_radius_m(const SphereScene& scene) noexcept {
  const double height_m = scene.floor_m - scene.center.y;
  const double ring_m =
      std::sqrt(std::max(0.0, (scene.radius_m - height_m) * (scene.radius_m + height_m)));
  return ring_m < kLeastRing * scene.radius_m ? 0 : ring_m;
}

// The ghost on its way to one place of the hand.
class Run {
 public:
  Run(const SphereScene& scene, const SphereGhost& from, Position3 target) noexcept
      : scene_(scene), ghost_(from), target_(target), ring_m_(ring_radius_m(scene)) {}

  // One leg. False: it has arrived where no way leads nearer.
  bool advance() noexcept {
    switch (hold()) {
      case Hold::None:
        return go_straight(target_);
      case Hold::Floor:
        return go_straight({target_.x, scene_.floor_m, target_.z});
      case Hold::Sphere:
        return slide_on_sphere();
      case Hold::Both:
        // Under a ball that rests on one point a point finger passes.
        return ring_m_ > 0 ? slide_on_ring() : go_straight({target_.x, scene_.floor_m, target_.z});
    }
    return false;
  }

  [[nodiscard]] const SphereGhost& ghost() const noexcept { return ghost_; }

  // What keeps the ghost from going straight at the hand: the faces of the cone of free directions
  // on which the straight way ends up.
  [[nodiscard]] Hold hold() const noexcept {
    const Displacement3 way = target_ - ghost_.position;
    const Direction3 up = outward();
    const bool is_down = ghost_.is_on_floor && way.y < 0;
    const bool is_inward = ghost_.is_on_sphere && dot(up, way) < 0;
    if (!is_down && !is_inward) return Hold::None;
    const Displacement3 level{way.x, 0, way.z};
    if (is_down && (!ghost_.is_on_sphere || dot(up, level) >= 0)) return Hold::Floor;
    const double rise_m = way.y - dot(up, way) * up.y;
    if (is_inward && (!ghost_.is_on_floor || rise_m >= 0)) return Hold::Sphere;
    return Hold::Both;
  }

  [[nodiscard]] Direction3 outward() const noexcept {
    const Displacement3 from_center = ghost_.position - scene_.center;
    return direction_of(from_center, norm(from_center));
  }

 private:
  // Whoever is on the ball here is leaving it: a straight line does not come back to a ball.
  bool go_straight(Position3 to) noexcept {
    const Displacement3 way = to - ghost_.position;
    if (norm(way) == 0) return false;
    const double at_sphere = ghost_.is_on_sphere ? 2 : sphere_on(way);
    const double at_floor = !ghost_.is_on_floor && way.y < 0
                                ? std::max(0.0, (scene_.floor_m - ghost_.position.y) / way.y)
                                : 2;
    ghost_.is_on_sphere = false;
    if (way.y > 0) ghost_.is_on_floor = false;
    const double share = std::min(at_sphere, at_floor);
    if (share > 1) {
      ghost_.position = to;
      return false;
    }
    ghost_.position = ghost_.position + share * way;
    ghost_.is_on_sphere = at_sphere == share;
    ghost_.is_on_floor = ghost_.is_on_floor || at_floor == share;
    snap();
    return true;
  }

  // Share of the way at which it enters the ball; above 1: it does not.
  [[nodiscard]] double sphere_on(Displacement3 way) const noexcept {
    const Displacement3 from = ghost_.position - scene_.center;
    const double outside_m2 = dot(from, from) - scene_.radius_m * scene_.radius_m;
    const double half = dot(from, way);
    const double root = half * half - dot(way, way) * outside_m2;
    if (half >= 0 || root <= 0) return 2;
    return std::max(0.0, outside_m2 / (std::sqrt(root) - half));
  }

  // Along the great circle towards the hand; to its nearest point of the ball, or to where the ball
  // is no longer in the way.
  bool slide_on_sphere() noexcept {
    const Displacement3 to_target = target_ - scene_.center;
    const double distance_m = norm(to_target);
    if (distance_m == 0) return false;
    const Direction3 start = outward();
    const Direction3 wanted = direction_of(to_target, distance_m);
    const double cosine = dot(start, wanted);
    const Direction3 aside = wanted - cosine * start;
    const double sine = norm(aside);
    const bool is_inside = distance_m <= scene_.radius_m;
    const double end = is_inside ? 0 : std::acos(scene_.radius_m / distance_m);
    const double turn = std::atan2(sine, cosine) - end;
    // Also the hand dead behind the centre: every way is as good, none is taken.
    if (sine < kNegligible_rad || turn <= kNegligible_rad) {
      return !is_inside && cosine > 0 && go_straight(target_);
    }
    const Direction3 along_circle = (1 / sine) * aside;
    const double at_floor = floor_on_circle(start.y, along_circle.y);
    const double angle = std::min(turn, at_floor);
    const Direction3 at = std::cos(angle) * start + std::sin(angle) * along_circle;
    ghost_.position = scene_.center + along<DisplacementTag>(at, scene_.radius_m);
    ghost_.is_on_floor = at_floor <= turn;
    snap();
    if (ghost_.is_on_floor) return true;
    return !is_inside && go_straight(target_);
  }

  // Angle at which a circle that starts at height `y0` and climbs by `slope`, in radii from the
  // centre, sinks below the floor; beyond a full turn: never.
  [[nodiscard]] double floor_on_circle(double y0, double slope) const noexcept {
    const double floor = (scene_.floor_m - scene_.center.y) / scene_.radius_m;
    const double reach = std::hypot(y0, slope);
    if (floor < -reach) return 3 * std::numbers::pi;
    const double half = std::acos(std::clamp(floor / reach, -1.0, 1.0));
    return std::max(0.0, std::atan2(slope, y0) + half);
  }

  bool slide_on_ring() noexcept {
    const double from =
        std::atan2(ghost_.position.z - scene_.center.z, ghost_.position.x - scene_.center.x);
    const double x_m = target_.x - scene_.center.x;
    const double z_m = target_.z - scene_.center.z;
    const double distance_m = std::hypot(x_m, z_m);
    if (distance_m == 0) return false;
    const double way = std::remainder(std::atan2(z_m, x_m) - from, 2 * std::numbers::pi);
    const double end = ring_release(std::abs(way), distance_m);
    const double angle = from + std::copysign(std::abs(way) - end, way);
    ghost_.position = {scene_.center.x + ring_m_ * std::cos(angle), scene_.floor_m,
                       scene_.center.z + ring_m_ * std::sin(angle)};
    return end > 0;
  }

  // The angle from the hand's side of the ring at which the ball or the floor lets go; 0: neither
  // before the ghost is there. `distance_m`: of the hand from the ring's axis.
  [[nodiscard]] double ring_release(double angle, double distance_m) const noexcept {
    // The ball lets go where the floor leads past it, an overhanging ball where it leads upwards.
    std::array<double, 2> cosines{ring_m_ / distance_m, 2};
    const double height_m = scene_.floor_m - scene_.center.y;
    if (height_m < 0) {
      const double climb_m = (target_.y - scene_.floor_m) * ring_m_ / height_m;
      cosines[1] = (climb_m + ring_m_) / distance_m;
    }
    double end = 0;
    for (const double cosine : cosines) {
      if (std::abs(cosine) >= 1) continue;
      const double at = std::acos(cosine);
      if (at < angle) end = std::max(end, at - kBeyond_rad);
    }
    return end;
  }

  // Onto the surfaces that it is said to be on, to the last bit that doubles have.
  void snap() noexcept {
    Position3& at = ghost_.position;
    if (ghost_.is_on_floor && ghost_.is_on_sphere && ring_m_ > 0) {
      const double x_m = at.x - scene_.center.x;
      const double z_m = at.z - scene_.center.z;
      const double scale = ring_m_ / std::hypot(x_m, z_m);
      at = {scene_.center.x + scale * x_m, scene_.floor_m, scene_.center.z + scale * z_m};
      return;
    }
    if (ghost_.is_on_sphere) {
      at = scene_.center + along<DisplacementTag>(outward(), scene_.radius_m);
    }
    at.y = ghost_.is_on_floor ? scene_.floor_m : std::max(at.y, scene_.floor_m);
  }

  const SphereScene& scene_;
  SphereGhost ghost_;
  Position3 target_;
  double ring_m_;
};

[[nodiscard]] ContactPlane plane_of(Direction3 outward, Position3 at) noexcept {
  ContactPlane plane;
  plane.normal = -outward;
  plane.offset_m = dot(plane.normal, at);
  return plane;
}

[[nodiscard]] bool is_free(const SphereScene& scene, Position3 p) noexcept {
  return p.y >= scene.floor_m && norm(p - scene.center) >= scene.radius_m;
}

}  // namespace

SphereGhost place_ghost(const SphereScene& scene, Position3 hand) noexcept {
  if (is_free(scene, hand)) return {hand, false, false};
  const Displacement3 from_center = hand - scene.center;
  const double distance_m = norm(from_center);
  const Direction3 out =
      distance_m > 0 ? direction_of(from_center, distance_m) : Direction3{0, 1, 0};
  const Position3 on_sphere = scene.center + along<DisplacementTag>(out, scene.radius_m);
  if (distance_m < scene.radius_m && on_sphere.y >= scene.floor_m) return {on_sphere, true, false};
  const Position3 on_floor{hand.x, scene.floor_m, hand.z};
  if (norm(on_floor - scene.center) >= scene.radius_m) return {on_floor, false, true};
  const double level_m = std::hypot(from_center.x, from_center.z);
  const double scale = level_m > 0 ? ring_radius_m(scene) / level_m : 0;
  Position3 on_ring{scene.center.x + scale * from_center.x, scene.floor_m,
                    scene.center.z + scale * from_center.z};
  if (level_m == 0) on_ring.x += ring_radius_m(scene);
  return {on_ring, true, true};
}

ProbeMotion move_ghost(const SphereScene& scene, SphereGhost& ghost, Position3 hand) noexcept {
  if (!is_finite(hand)) return {ghost.position, {}, false};
  Position3 target = hand;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    target[axis] = std::clamp(target[axis], -kFar_m, kFar_m);
  }
  Run run(scene, ghost, target);
  for (int leg = 0; leg < kMaxLegs && run.advance(); ++leg) {
  }
  ghost = run.ghost();
  ProbeMotion motion{ghost.position, {}, false};
  const Hold hold = run.hold();
  if (hold == Hold::Sphere || hold == Hold::Both) {
    motion.planes.push_back(plane_of(run.outward(), ghost.position));
  }
  if (hold == Hold::Floor || hold == Hold::Both) {
    motion.planes.push_back(plane_of({0, 1, 0}, ghost.position));
  }
  return motion;
}

}  // namespace thimble::world
