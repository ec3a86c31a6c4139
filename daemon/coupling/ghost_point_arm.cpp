#include "daemon/coupling/ghost_point_arm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/coupling/wall_penalty.hpp"

namespace thimble::coupling {
namespace {

// Normals closer than 14° are the same face of a curved surface; voxel faces differ by 90°.
constexpr double kSameFaceCosine = 0.97;
constexpr double kSameNormalCosine = 1 - 1e-9;
// Shifts below are rounding, not events; relaxation stops this far before a wall.
constexpr double kNegligible_m = 1e-9;
constexpr double kStandoff_m = 1e-6;
// A servo that stalled longer does not move the frame by the whole stall at once.
constexpr double kLongestStep_s = 0.02;

double depth_m(const ConstraintPlane& plane, Position3 hand) noexcept {
  return dot(plane.normal, hand) - plane.offset_m;
}

// The sum in order of size: permuted axes give the same bits.
double symmetric_norm(Displacement3 v) noexcept {
  std::array<double, 3> size{std::abs(v.x), std::abs(v.y), std::abs(v.z)};
  std::sort(size.begin(), size.end());
  return norm(size[0], size[1], size[2]);
}

}  // namespace

double effective_hysteresis_m(const GhostPointSettings& settings) noexcept {
  if (!(settings.cell_m > 0)) return settings.hysteresis_m;
  return std::min(settings.hysteresis_m, settings.cell_m / 4);
}

GhostPointArm::GhostPointArm(const GhostPointSettings& settings) noexcept
    : settings_(settings), hysteresis_m_(effective_hysteresis_m(settings)), age_(settings.age) {}

void GhostPointArm::reset(MonotonicTime now, Position3 tip) noexcept {
  ++restarts_;
  age_.restart(now);
  contacts_.clear();
  offset_ = {};
  last_hand_ = is_finite(tip) ? tip : Position3{};
  applied_reply_ = 0;
  has_set_ = false;
}

ArmOutput GhostPointArm::step(const ArmInput& input) noexcept {
  ++sequence_;
  if (!is_finite(input.tip) || !is_finite(input.tip_velocity)) return refuse(input);

  age_.update(input);
  if (input.fresh != nullptr) apply(*input.fresh, input);
  if (age_.has_expired()) contacts_.clear();
  if (!age_.is_frozen()) relax(input);
  last_hand_ = input.tip + offset_;

  ArmOutput output;
  press(input, output);
  output.offset = offset_;
  output.is_frozen = age_.is_frozen();
  output.is_fading = age_.is_fading();
  HandSample& sample = output.sample;
  sample.sequence = sequence_;
  sample.sampled_at = input.now;
  sample.hand = last_hand_;
  sample.velocity = input.tip_velocity;
  sample.buttons = input.buttons;
  sample.applied_reply = applied_reply_;
  sample.restart = restarts_;
  return output;
}

ArmOutput GhostPointArm::refuse(const ArmInput& input) const noexcept {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  ArmOutput output;
  output.force = {kNotANumber, kNotANumber, kNotANumber};
  output.offset = offset_;
  output.is_frozen = age_.is_frozen();
  output.is_fading = age_.is_fading();
  output.sample = {.sequence = sequence_,
                   .sampled_at = input.now,
                   .hand = last_hand_,
                   .velocity = {},
                   .buttons = input.buttons,
                   .applied_reply = applied_reply_,
                   .restart = restarts_};
  return output;
}

// Of several planes with one normal only the tightest constrains.
PlaneList GhostPointArm::sound_planes(const PlaneList& planes) noexcept {
  PlaneList sound;
  for (const ConstraintPlane& plane : planes) {
    if (!is_sound(plane)) {
      ++counters_.rejected_planes;
      continue;
    }
    auto* const twin = std::find_if(sound.begin(), sound.end(), [&](const ConstraintPlane& other) {
      return dot(other.normal, plane.normal) >= kSameNormalCosine;
    });
    if (twin == sound.end()) {
      sound.push_back(plane);
    } else if (plane.offset_m < twin->offset_m) {
      *twin = plane;
    }
  }
  return sound;
}

bool GhostPointArm::names_what_is_held(const PlaneList& planes) const noexcept {
  return std::equal(planes.begin(), planes.end(), contacts_.begin(), contacts_.end(),
                    [](const ConstraintPlane& plane, const Contact& contact) {
                      return contact.is_held && contact.plane == plane;
                    });
}

void GhostPointArm::apply(const ConstraintSet& set, const ArmInput& input) noexcept {
  const bool is_void = !has_set_ || set.session != session_ || age_.has_returned();
  has_set_ = true;
  session_ = set.session;
  applied_reply_ = set.sequence;
  // Most replies repeat the last one; with nothing to learn or to forget all stays as it is.
  if (!is_void && names_what_is_held(set.planes)) return;

  // What is felt now, before anything shifts: the measure of "no jump".
  const Position3 hand_before = input.tip + offset_;
  ContactList next;
  std::array<bool, kMaxContacts> is_taken{};
  for (const ConstraintPlane& plane : sound_planes(set.planes)) {
    std::size_t best = contacts_.size();
    double best_cosine = kSameFaceCosine;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const double cosine = dot(contacts_[i].plane.normal, plane.normal);
      if (is_taken[i] || cosine < best_cosine) continue;
      best = i;
      best_cosine = cosine;
    }
    if (best == contacts_.size()) {
      next.push_back(adopt(plane, nullptr, input.tip, 0, is_void));
      continue;
    }
    is_taken[best] = true;
    const Contact& known = contacts_[best];
    const double felt_m = known.is_held ? std::max(0.0, depth_m(known.plane, hand_before)) : 0.0;
    next.push_back(adopt(plane, &known, input.tip, felt_m, is_void));
  }
  if (!is_void) remember(is_taken, input, next);
  contacts_ = next;
}

// Takes a plane into the list and, where it is news that the hand is past it, shifts the
// frame along its normal until the finger is inside by no more than it already felt, or H.
GhostPointArm::Contact GhostPointArm::adopt(const ConstraintPlane& plane, const Contact* known,
                                            Position3 tip, double depth_felt_m,
                                            bool is_void) noexcept {
  Contact contact = known != nullptr ? *known : Contact{};
  const bool is_unchanged = known != nullptr && known->is_held && known->plane == plane && !is_void;
  contact.plane = plane;
  contact.is_held = true;
  contact.is_barrier = true;
  if (is_unchanged) return contact;
  if (depth_felt_m > 0) {
    contact.spring.become(stiffness_of(plane), depth_felt_m);
  } else {
    contact.spring.reset(stiffness_of(plane));
  }

  double keep_m = depth_felt_m > 0 ? depth_felt_m : hysteresis_m_;
  if (depth_felt_m > 0 && age_.has_returned()) {
    keep_m = std::max(hysteresis_m_, keep_m * age_.gain());
  }
  const double depth = depth_m(plane, tip + offset_);
  if (depth <= hysteresis_m_ || depth - keep_m <= kNegligible_m) return contact;
  shift(along<DisplacementTag>(plane.normal, keep_m - depth));
  // What the frame could not yield, the wall does: a reply never kicks.
  const double left_m = depth_m(plane, tip + offset_) - keep_m;
  if (left_m > kNegligible_m) contact.spring.sink(left_m);
  ++counters_.offset_events;
  contact.ramp_from_m = contact.shown_m;
  contact.ramp_elapsed_s = 0;
  return contact;
}

void GhostPointArm::remember(const std::array<bool, kMaxContacts>& is_taken, const ArmInput& input,
                             ContactList& next) const noexcept {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (is_taken[i]) continue;
    Contact contact = contacts_[i];
    contact.is_held = false;
    contact.is_pressing = false;
    contact.spring.reset(stiffness_of(contact.plane));
    contact.ramp_from_m = 0;
    contact.shown_m = 0;
    // A hand well past a face that the world does not name disproves the face.
    if (depth_m(contact.plane, input.tip + offset_) > hysteresis_m_) contact.is_barrier = false;
    if (contact.is_barrier || was_pressed_lately(contact, input.now)) next.push_back(contact);
  }
}

// Straight towards the origin, or towards the nearest place that the known faces leave free.
void GhostPointArm::relax(const ArmInput& input) noexcept {
  const Position3 hand = input.tip + offset_;
  const auto room_m = [hand](const Contact& contact) {
    return std::max(0.0, -depth_m(contact.plane, hand) - kStandoff_m);
  };
  Displacement3 way = -offset_;
  for (const Contact& contact : contacts_) {
    if (!contact.is_barrier) continue;
    const double excess_m = dot(contact.plane.normal, way) - room_m(contact);
    if (excess_m > 0) way -= along<DisplacementTag>(contact.plane.normal, excess_m);
  }
  // Oblique faces can undo each other's correction; then the frame stays where it is.
  for (const Contact& contact : contacts_) {
    if (!contact.is_barrier) continue;
    if (dot(contact.plane.normal, way) > room_m(contact) + kNegligible_m) return;
  }
  const double length_m = symmetric_norm(way);
  if (!(length_m > 0)) return;
  const double dt_s = std::clamp(seconds(input.dt), 0.0, kLongestStep_s);
  shift(std::min(1.0, settings_.relaxation_m_per_s * dt_s / length_m) * way);
}

// No plane, however absurd, moves the frame further than an arm reaches (decision 0056). The
// shift is cut, not the offset: walls across it must not feel anything of it.
void GhostPointArm::shift(Displacement3 by) noexcept {
  const double max_m = settings_.max_offset_m;
  if (symmetric_norm(offset_ + by) <= max_m) {
    offset_ += by;
    return;
  }
  const double length_m = symmetric_norm(by);
  if (!std::isfinite(length_m) || !(length_m > 0)) return;
  const Displacement3 way = (1 / length_m) * by;
  const double along_m = dot(way, offset_);
  const double room_m2 = max_m * max_m - dot(offset_, offset_);
  const double reach_m = std::sqrt(std::max(0.0, along_m * along_m + room_m2)) - along_m;
  offset_ += std::clamp(reach_m, 0.0, length_m) * way;
}

void GhostPointArm::press(const ArmInput& input, ArmOutput& output) noexcept {
  Force3 force{};
  update_spring_budget(input.now);
  for (Contact& contact : contacts_) {
    if (!contact.is_held) continue;
    const double depth = depth_m(contact.plane, last_hand_);
    if (!(depth > contact.spring.gap_m())) {
      contact.is_pressing = false;
      contact.shown_m = 0;
      if (!(depth > 0)) contact.spring.reset(stiffness_of(contact.plane));
      continue;
    }
    if (!contact.is_pressing) {
      begin(contact, input, output);
    } else {
      advance_ramp(contact, input.dt, depth);
    }
    contact.has_pressed = true;
    contact.last_pressed = input.now;
    output.is_in_contact = true;
    const double speed_m_per_s = dot(contact.plane.normal, input.tip_velocity);
    const double wall_newton = contact.spring.force_newton(depth);
    // Bounded by the wall's own share, else a strong spring throws a light hand out, lets it
    // come back, and throws it out again (decision 0055).
    const double spring_newton =
        std::min(settings_.coordinate_spring.newton_per_m * contact.shown_m,
                 settings_.coordinate_spring_share * wall_newton);
    const double push_newton =
        wall_newton + spring_newton + damping_of(contact.plane).newton_s_per_m * speed_m_per_s;
    if (push_newton > 0) force -= along<ForceTag>(contact.plane.normal, push_newton);
    if (friction_of(contact.plane) > 0) force += rub(contact, input, wall_newton);
  }
  output.force = age_.gain() * force;
}

void GhostPointArm::begin(Contact& contact, const ArmInput& input, ArmOutput& output) noexcept {
  if (was_pressed_lately(contact, input.now)) {
    ++counters_.redetections;
  } else {
    ++output.new_contacts;
  }
  contact.is_pressing = true;
  contact.ramp_from_m = 0;
  contact.ramp_elapsed_s = 0;
  contact.shown_m = 0;
  contact.stuck_at = input.tip;
}

// A spring along the surface whose foot slips as soon as it is stretched more than the wall's push
// holds: it depends on the way, not on the time, and gives back no more than it took (decision
// 0129). Across the surface it does nothing.
Force3 GhostPointArm::rub(Contact& contact, const ArmInput& input,
                          double wall_newton) const noexcept {
  const Direction3 normal = contact.plane.normal;
  Displacement3 stretch = input.tip - contact.stuck_at;
  stretch -= along<DisplacementTag>(normal, dot(normal, stretch));
  const double stiffness = stiffness_of(contact.plane).newton_per_m;
  const double hold_newton = friction_of(contact.plane) * wall_newton;
  const double length_m = symmetric_norm(stretch);
  if (stiffness * length_m > hold_newton)
    stretch = (hold_newton / (stiffness * length_m)) * stretch;
  contact.stuck_at = input.tip - stretch;
  const Velocity3 velocity = input.tip_velocity;
  const Velocity3 sliding = velocity - along<VelocityTag>(normal, dot(normal, velocity));
  const double damping = damping_of(contact.plane).newton_s_per_m;
  const Displacement3 wanted{stiffness * stretch.x + damping * sliding.x,
                             stiffness * stretch.y + damping * sliding.y,
                             stiffness * stretch.z + damping * sliding.z};
  const double size_newton = symmetric_norm(wanted);
  const double share = size_newton > hold_newton ? hold_newton / size_newton : 1;
  return Force3{-share * wanted.x, -share * wanted.y, -share * wanted.z};
}

bool GhostPointArm::was_pressed_lately(const Contact& contact, MonotonicTime now) const noexcept {
  return contact.has_pressed && now - contact.last_pressed <= settings_.redetection_guard;
}

// What teleop.md 2(e) grants the coordinate spring in one touch, and no more (decision 0057). A
// face that is found again within the guard has its old touch to thank for what the spring gave.
void GhostPointArm::update_spring_budget(MonotonicTime now) noexcept {
  const auto is_pressing = [](const Contact& contact) { return contact.is_pressing; };
  const auto is_recent = [&](const Contact& contact) { return was_pressed_lately(contact, now); };
  const double offset_m2 = dot(offset_, offset_);
  const bool is_touching = std::any_of(contacts_.begin(), contacts_.end(), is_pressing);
  touch_offset_m2_ = is_touching ? std::max(touch_offset_m2_, offset_m2) : offset_m2;
  if (std::none_of(contacts_.begin(), contacts_.end(), is_recent)) spring_spent_joule_ = 0;
}

// Only a frame that was pushed away along the normal pulls back; one displaced the other way
// would draw the finger into the wall. A spring that grows under a finger that presses gives the
// hand the growth times the depth; a finger deeper than half of the offset would get more than
// the shift stored.
void GhostPointArm::advance_ramp(Contact& contact, Duration dt, double depth) noexcept {
  const double target_m = std::max(0.0, -dot(contact.plane.normal, offset_));
  const double ramp_s = seconds(settings_.coordinate_spring_ramp);
  contact.ramp_elapsed_s += std::max(0.0, seconds(dt));
  const double share = ramp_s > 0 ? std::min(1.0, contact.ramp_elapsed_s / ramp_s) : 1.0;
  const double wanted_m = contact.ramp_from_m + (target_m - contact.ramp_from_m) * share;
  const double price_newton = settings_.coordinate_spring.newton_per_m * depth;
  const double granted_joule =
      settings_.coordinate_spring.newton_per_m * touch_offset_m2_ / 2 - spring_spent_joule_;
  double rise_m = wanted_m - contact.shown_m;
  // What waited for the budget comes as slowly as what did not.
  if (ramp_s > 0) rise_m = std::min(rise_m, target_m * std::max(0.0, seconds(dt)) / ramp_s);
  if (rise_m * price_newton > granted_joule) rise_m = std::max(0.0, granted_joule) / price_newton;
  spring_spent_joule_ += std::max(0.0, rise_m) * price_newton;
  contact.shown_m += rise_m;
}

Stiffness GhostPointArm::stiffness_of(const ConstraintPlane& plane) const noexcept {
  if (!(plane.surface.stiffness.newton_per_m >= 0)) return settings_.stiffness;
  return std::min(plane.surface.stiffness, settings_.max_stiffness);
}

double GhostPointArm::friction_of(const ConstraintPlane& plane) const noexcept {
  if (!(plane.surface.friction >= 0)) return settings_.friction;
  return std::min(plane.surface.friction, settings_.max_friction);
}

Damping GhostPointArm::damping_of(const ConstraintPlane& plane) const noexcept {
  if (!(plane.surface.damping.newton_s_per_m >= 0)) return settings_.damping;
  return std::min(plane.surface.damping, settings_.max_damping);
}

}  // namespace thimble::coupling
