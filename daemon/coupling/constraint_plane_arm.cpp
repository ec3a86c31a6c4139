#include "daemon/coupling/constraint_plane_arm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/coupling/surface_touch.hpp"
#include "daemon/coupling/told_planes.hpp"

namespace thimble::coupling {
namespace {

using world::PastPlanes;
using world::PlaneProjection;
using world::project;

// What is left of `v` along the planes that hold the proxy.
template <class Quantity>
Vector3<Quantity> along_planes(Vector3<Quantity> v,
                               const std::array<Direction3, 3>& across) noexcept {
  for (const Direction3& direction : across) v -= along<Quantity>(direction, dot(direction, v));
  return v;
}

}  // namespace

ConstraintPlaneArm::ConstraintPlaneArm(const ConstraintPlaneSettings& settings) noexcept
    : settings_(settings),
      hysteresis_m_(effective_hysteresis_m(settings.hysteresis_m, settings.cell_m)),
      age_(settings.age),
      frame_(settings.max_offset_m),
      recovery_(settings.max_offset_m) {}

void ConstraintPlaneArm::restart(MonotonicTime now, Position3 tip) noexcept {
  ++restarts_;
  age_.restart(now);
  frame_.reset();
  recovery_.reset();
  yield_ = {};
  faces_.clear();
  held_ = 0;
  is_touching_ = false;
  last_tip_ = is_finite(tip) ? tip : Position3{};
  applied_reply_ = 0;
  has_set_ = false;
}

ArmOutput ConstraintPlaneArm::advance(const ArmInput& input) noexcept {
  ++sequence_;
  if (!is_finite(input.tip) || !is_finite(input.tip_velocity)) return refuse(input);
  last_tip_ = input.tip;

  age_.update(input);
  if (input.fresh != nullptr) apply(*input.fresh, input);
  if (age_.has_expired()) {
    faces_.clear();
    held_ = 0;
  }
  if (!age_.is_frozen()) {
    recover(input.dt);
    relax(input);
  }
  ArmOutput output;
  press(input, output);
  describe(input, output);
  output.sample.velocity = input.tip_velocity;
  return output;
}

ArmOutput ConstraintPlaneArm::refuse(const ArmInput& input) const noexcept {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  ArmOutput output;
  output.force = {kNotANumber, kNotANumber, kNotANumber};
  describe(input, output);
  return output;
}

void ConstraintPlaneArm::describe(const ArmInput& input, ArmOutput& output) const noexcept {
  output.offset = frame_.offset();
  output.is_frozen = age_.is_frozen();
  output.is_fading = age_.is_fading();
  HandSample& sample = output.sample;
  sample.sequence = sequence_;
  sample.sampled_at = input.now;
  sample.hand = last_tip_ + frame_.offset();
  sample.buttons = input.buttons;
  sample.applied_reply = applied_reply_;
  sample.restart = restarts_;
}

Position3 ConstraintPlaneArm::rendered(Position3 tip) const noexcept {
  return tip + frame_.offset() + recovery();
}

PastPlanes ConstraintPlaneArm::past_held(Position3 hand) const noexcept {
  PastPlanes past;
  for (std::size_t i = 0; i < held_; ++i) {
    past.push_back({faces_[i].plane.normal, depth_m(faces_[i].plane, hand)});
  }
  return past;
}

bool ConstraintPlaneArm::names_what_is_held(const PlaneList& planes) const noexcept {
  return held_ == faces_.size() &&
         std::equal(
             planes.begin(), planes.end(), faces_.begin(), faces_.end(),
             [](const ConstraintPlane& plane, const Face& face) { return face.plane == plane; });
}

void ConstraintPlaneArm::apply(const ConstraintSet& set, const ArmInput& input) noexcept {
  const bool is_void = !has_set_ || set.session != session_ || age_.has_returned();
  has_set_ = true;
  session_ = set.session;
  applied_reply_ = set.sequence;
  // Most replies repeat the last one; with nothing to learn or to forget all stays as it is.
  if (!is_void && names_what_is_held(set.planes)) return;

  // What is felt now, before anything gives way: the measure of "no jump".
  const Position3 hand = rendered(input.tip);
  const double shown = age_.has_returned() ? age_.gain() : 1;
  const double felt_m = shown * symmetric_length_m(project(past_held(hand)).past);
  const std::uint64_t news_before = counters_.news;
  FaceList next;
  PastPlanes too_deep;
  std::array<bool, kMaxFaces> is_taken{};
  for (const ConstraintPlane& plane : sound_planes(set.planes, counters_.rejected_planes)) {
    const std::size_t same = find_same_face(faces_, is_taken, plane);
    const ConstraintPlane* const held = same < held_ ? &faces_[same].plane : nullptr;
    too_deep.push_back({plane.normal, depth_m(plane, hand) - kept_m(plane, held, hand, is_void)});
    Face face = same < faces_.size() ? faces_[same] : Face{};
    face.plane = plane;
    face.is_barrier = true;
    next.push_back(face);
    if (same < faces_.size()) is_taken[same] = true;
  }
  const FaceList known = faces_;
  faces_ = next;
  held_ = next.size();
  give_way(too_deep, felt_m, counters_.news - news_before, input.tip);
  if (is_void) return;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!is_taken[i]) remember(known[i], input);
  }
}

double ConstraintPlaneArm::kept_m(const ConstraintPlane& plane, const ConstraintPlane* held,
                                  Position3 hand, bool is_void) noexcept {
  const double depth = depth_m(plane, hand);
  const bool is_unchanged = held != nullptr && *held == plane && !is_void;
  if (is_unchanged) return std::max(0.0, depth);
  ++counters_.news;
  const double felt_m = held != nullptr ? std::max(0.0, depth_m(*held, hand)) : 0.0;
  double keep_m = felt_m > 0 ? felt_m : hysteresis_m_;
  if (felt_m > 0 && age_.has_returned()) keep_m = std::max(hysteresis_m_, keep_m * age_.gain());
  const bool is_late = depth > hysteresis_m_ && depth - keep_m > kNegligible_m;
  return is_late ? keep_m : std::max(0.0, depth);
}

// A face that the newest set does not name. A hand well past it disproves it.
void ConstraintPlaneArm::remember(Face face, const ArmInput& input) noexcept {
  face.is_pressing = false;
  if (depth_m(face.plane, rendered(input.tip)) > hysteresis_m_) face.is_barrier = false;
  const bool is_recent =
      face.has_pressed && input.now - face.last_pressed <= settings_.redetection_guard;
  if (face.is_barrier || is_recent) faces_.push_back(face);
}

// `too_deep`: how much deeper in each plane the hand is than it may be.
void ConstraintPlaneArm::give_way(const PastPlanes& too_deep, double felt_m, std::uint64_t news,
                                  Position3 tip) noexcept {
  const Displacement3 first = project(too_deep).past;
  const bool has_first = symmetric_length_m(first) > kNegligible_m;
  if (has_first) yield(first);
  const double most_m =
      std::sqrt(felt_m * felt_m + static_cast<double>(news) * hysteresis_m_ * hysteresis_m_);
  const Displacement3 past = project(past_held(rendered(tip))).past;
  const double past_m = symmetric_length_m(past);
  const bool has_more = past_m - most_m > kNegligible_m;
  if (has_more) yield((1 - most_m / past_m) * past);
  if (has_first || has_more) ++counters_.late_walls;
}

void ConstraintPlaneArm::yield(Displacement3 past) noexcept {
  const bool recovers = settings_.late_walls == LateWalls::Recovery;
  CoordinateFrame& taker = recovers ? recovery_ : frame_;
  const Displacement3 before = taker.offset();
  taker.shift(-past);
  yield_ -= past + (taker.offset() - before);
  if (symmetric_length_m(yield_) <= kNegligible_m) yield_ = {};
  const double recovery_m = symmetric_length_m(recovery_.offset());
  if (recovery_m > 0) recovery_m_per_s_ = recovery_m / seconds(settings_.recovery_time);
}

void ConstraintPlaneArm::recover(Duration dt) noexcept {
  const double left_m = symmetric_length_m(recovery_.offset());
  if (!(left_m > 0)) return;
  const double dt_s = std::clamp(seconds(dt), 0.0, kLongestStep_s);
  recovery_.shift(-std::min(1.0, recovery_m_per_s_ * dt_s / left_m) * recovery_.offset());
}

// What the walls yield first: no frame is as far away.
void ConstraintPlaneArm::relax(const ArmInput& input) noexcept {
  const bool yields = yield_ != Displacement3{};
  const Displacement3 away = yields ? yield_ : frame_.offset();
  if (away == Displacement3{}) return;
  const Displacement3 way = free_way(-away, rendered(input.tip));
  const double length_m = symmetric_length_m(way);
  if (!(length_m > 0)) return;
  const double dt_s = std::clamp(seconds(input.dt), 0.0, kLongestStep_s);
  const Displacement3 by = std::min(1.0, settings_.relaxation_m_per_s * dt_s / length_m) * way;
  if (yields) {
    yield_ += by;
  } else {
    frame_.shift(by);
  }
}

// Straight on as `wanted`, or to the nearest place that the known faces leave free. A way that is
// free for the proxy stretches the spring between it and the hand no further: the hand is given
// nothing. Of the faces only those that are in the way are taken into the projection, as they turn
// out to be.
Displacement3 ConstraintPlaneArm::free_way(Displacement3 wanted, Position3 hand) const noexcept {
  const Position3 proxy = hand - project(past_held(hand)).past;
  PastPlanes crossed;
  std::array<bool, kMaxFaces> is_crossed{};
  Displacement3 way = wanted;
  for (std::size_t round = 0; round <= kMaxPlanes; ++round) {
    const std::size_t before = crossed.size();
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      if (is_crossed[i] || !faces_[i].is_barrier) continue;
      const Direction3 normal = faces_[i].plane.normal;
      const Position3 from = i < held_ ? proxy : hand;
      const double room_m = std::max(0.0, -depth_m(faces_[i].plane, from) - kStandoff_m);
      if (dot(normal, way) - room_m <= world::kPlaneTolerance_m) continue;
      is_crossed[i] = true;
      if (!crossed.push_back({normal, dot(normal, wanted) - room_m})) return {};
    }
    if (crossed.size() == before) return way;
    const PlaneProjection nearest = project(crossed);
    if (!nearest.has_place) return {};
    way = wanted - nearest.past;
  }
  return {};
}

void ConstraintPlaneArm::press(const ArmInput& input, ArmOutput& output) noexcept {
  const PlaneProjection proxy = project(past_held(rendered(input.tip)));
  note_pressing(proxy, input.now, output);
  const double depth = symmetric_length_m(proxy.past);
  if (!(depth > 0)) {
    is_touching_ = false;
    return;
  }
  const SurfaceProperties surface = surface_under(proxy);
  if (!is_touching_) {
    spring_.reset(surface.stiffness);
    stuck_at_ = input.tip;
  } else if (surface.stiffness != stiffness_) {
    spring_.become(surface.stiffness, depth);
  }
  stiffness_ = surface.stiffness;
  is_touching_ = true;
  output.is_in_contact = true;
  const double wall_newton = spring_.force_newton(depth);
  Force3 force = push(proxy, wall_newton / depth, input.tip_velocity, surface.damping);
  if (surface.friction > 0) force += rub_along(proxy, input, surface, wall_newton);
  output.force = age_.gain() * force;
}

void ConstraintPlaneArm::note_pressing(const PlaneProjection& proxy, MonotonicTime now,
                                       ArmOutput& output) noexcept {
  for (std::size_t i = 0; i < held_; ++i) {
    Face& face = faces_[i];
    const bool was_pressing = face.is_pressing;
    face.is_pressing = proxy.share[i] > 0;
    if (!face.is_pressing) continue;
    const bool is_recent =
        face.has_pressed && now - face.last_pressed <= settings_.redetection_guard;
    if (!was_pressing && is_recent) ++counters_.redetections;
    if (!was_pressing && !is_recent) ++output.new_contacts;
    face.has_pressed = true;
    face.last_pressed = now;
  }
}

// Each plane's by its λ; where all are alike, exactly theirs.
SurfaceProperties ConstraintPlaneArm::surface_under(const PlaneProjection& proxy) const noexcept {
  SurfaceProperties out{};
  double weight_m = 0;
  for (std::size_t i = 0; i < held_; ++i) {
    if (!(proxy.share[i] > 0)) continue;
    const SurfaceProperties one = surface_of(faces_[i].plane, settings_);
    if (weight_m == 0) out = one;
    weight_m += proxy.share[i];
    const double part = proxy.share[i] / weight_m;
    out.stiffness.newton_per_m += part * (one.stiffness.newton_per_m - out.stiffness.newton_per_m);
    out.damping.newton_s_per_m += part * (one.damping.newton_s_per_m - out.damping.newton_s_per_m);
    out.friction += part * (one.friction - out.friction);
  }
  return out;
}

// What of spring and damper the planes can push: the point is their cone's projection, and
// project() finds it as it finds a proxy, with newtons for metres.
Force3 ConstraintPlaneArm::push(const PlaneProjection& proxy, double newton_per_m,
                                Velocity3 velocity, Damping damping) const noexcept {
  const double newton_s_per_m = damping.newton_s_per_m;
  const Force3 wish{newton_per_m * proxy.past.x + newton_s_per_m * velocity.x,
                    newton_per_m * proxy.past.y + newton_s_per_m * velocity.y,
                    newton_per_m * proxy.past.z + newton_s_per_m * velocity.z};
  PastPlanes cone;
  for (std::size_t i = 0; i < held_; ++i) {
    const Direction3 normal = faces_[i].plane.normal;
    if (proxy.share[i] > 0) cone.push_back({normal, dot(normal, wish)});
  }
  const Displacement3 pushed = project(cone).past;
  return {-pushed.x, -pushed.y, -pushed.z};
}

Force3 ConstraintPlaneArm::rub_along(const PlaneProjection& proxy, const ArmInput& input,
                                     const SurfaceProperties& surface,
                                     double wall_newton) noexcept {
  // Gram and Schmidt; parallel ones, of walls that contradict each other, add nothing.
  constexpr double kLeastSine = 1e-6;
  std::array<Direction3, 3> across{};
  std::size_t ways = 0;
  for (std::size_t i = 0; i < held_ && ways < across.size(); ++i) {
    if (!(proxy.share[i] > 0)) continue;
    const Direction3 rest = along_planes(faces_[i].plane.normal, across);
    const double sine = norm(rest);
    if (sine > kLeastSine) across[ways++] = (1 / sine) * rest;
  }
  Displacement3 stretch = along_planes(input.tip - stuck_at_, across);
  const Velocity3 sliding = along_planes(input.tip_velocity, across);
  const Force3 force = rub(stretch, sliding, surface, surface.friction * wall_newton);
  stuck_at_ = input.tip - stretch;
  return force;
}

}  // namespace thimble::coupling
