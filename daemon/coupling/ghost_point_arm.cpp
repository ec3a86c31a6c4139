#include "daemon/coupling/ghost_point_arm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/coupling/surface_touch.hpp"
#include "daemon/coupling/symmetric_dot.hpp"
#include "daemon/coupling/told_planes.hpp"

namespace thimble::coupling {

GhostPointArm::GhostPointArm(const GhostPointSettings& settings) noexcept
    : settings_(settings),
      hysteresis_m_(effective_hysteresis_m(settings.hysteresis_m, settings.cell_m)),
      age_(settings.age),
      frame_(settings.max_offset_m) {}

void GhostPointArm::restart(MonotonicTime now, Position3 tip) noexcept {
  ++restarts_;
  age_.restart(now);
  contacts_.clear();
  frame_.reset();
  last_hand_ = is_finite(tip) ? tip : Position3{};
  applied_reply_ = 0;
  has_set_ = false;
}

ArmOutput GhostPointArm::advance(const ArmInput& input) noexcept {
  return step_as_told(input, input.fresh);
}

ArmOutput GhostPointArm::step_as_told(const ArmInput& input, const ConstraintSet* said) noexcept {
  ++sequence_;
  if (!is_finite(input.tip) || !is_finite(input.tip_velocity)) return refuse(input);

  age_.update(input);
  // What is known here goes on being said while the world is silent, and is not felt any more.
  if (said != nullptr && !age_.has_expired()) apply(*said, input);
  if (age_.has_expired()) contacts_.clear();
  if (!age_.is_frozen()) relax(input);
  last_hand_ = input.tip + frame_.offset();

  ArmOutput output;
  press(input, output);
  output.offset = frame_.offset();
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
  output.offset = frame_.offset();
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
  const Position3 hand_before = input.tip + frame_.offset();
  ContactList next;
  std::array<bool, kMaxContacts> is_taken{};
  for (const ConstraintPlane& plane : sound_planes(set.planes, counters_.rejected_planes)) {
    const std::size_t best = find_same_face(contacts_, is_taken, plane);
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
    contact.spring.become(surface_of(plane, settings_).stiffness, depth_felt_m);
  } else {
    contact.spring.reset(surface_of(plane, settings_).stiffness);
  }

  double keep_m = depth_felt_m > 0 ? depth_felt_m : hysteresis_m_;
  if (depth_felt_m > 0 && age_.has_returned()) {
    keep_m = std::max(hysteresis_m_, keep_m * age_.gain());
  }
  const double depth = depth_m(plane, tip + frame_.offset());
  if (depth <= hysteresis_m_ || depth - keep_m <= kNegligible_m) return contact;
  frame_.shift(along<DisplacementTag>(plane.normal, keep_m - depth));
  // What the frame could not yield, the wall does: a reply never kicks.
  const double left_m = depth_m(plane, tip + frame_.offset()) - keep_m;
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
    contact.spring.reset(surface_of(contact.plane, settings_).stiffness);
    contact.ramp_from_m = 0;
    contact.shown_m = 0;
    // A hand well past a face that the world does not name disproves the face.
    if (depth_m(contact.plane, input.tip + frame_.offset()) > hysteresis_m_)
      contact.is_barrier = false;
    if (contact.is_barrier || was_pressed_lately(contact, input.now)) next.push_back(contact);
  }
}

// Straight towards the origin, or towards the nearest place that the known faces leave free.
void GhostPointArm::relax(const ArmInput& input) noexcept {
  const Position3 hand = input.tip + frame_.offset();
  const auto room_m = [hand](const Contact& contact) {
    return std::max(0.0, -depth_m(contact.plane, hand) - kStandoff_m);
  };
  Displacement3 way = -frame_.offset();
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
  const double length_m = symmetric_length_m(way);
  if (!(length_m > 0)) return;
  const double dt_s = std::clamp(seconds(input.dt), 0.0, kLongestStep_s);
  frame_.shift(std::min(1.0, settings_.relaxation_m_per_s * dt_s / length_m) * way);
}

void GhostPointArm::press(const ArmInput& input, ArmOutput& output) noexcept {
  Force3 force{};
  update_spring_budget(input.now);
  raise_springs(input.dt);
  for (Contact& contact : contacts_) {
    if (!contact.is_held) continue;
    const double depth = depth_m(contact.plane, last_hand_);
    if (!(depth > contact.spring.gap_m())) {
      contact.is_pressing = false;
      contact.shown_m = 0;
      if (!(depth > 0)) contact.spring.reset(surface_of(contact.plane, settings_).stiffness);
      continue;
    }
    if (!contact.is_pressing) begin(contact, input, output);
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
    const SurfaceProperties surface = surface_of(contact.plane, settings_);
    const double push_newton =
        wall_newton + spring_newton + surface.damping.newton_s_per_m * speed_m_per_s;
    if (push_newton > 0) force -= along<ForceTag>(contact.plane.normal, push_newton);
    if (surface.friction > 0) force += rub_along(contact, input, surface, wall_newton);
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

// The place is kept in the arm's frame: across the surface friction does nothing.
Force3 GhostPointArm::rub_along(Contact& contact, const ArmInput& input,
                                const SurfaceProperties& surface,
                                double wall_newton) const noexcept {
  const Direction3 normal = contact.plane.normal;
  Displacement3 stretch = input.tip - contact.stuck_at;
  stretch -= along<DisplacementTag>(normal, dot(normal, stretch));
  const Velocity3 velocity = input.tip_velocity;
  const Velocity3 sliding = velocity - along<VelocityTag>(normal, dot(normal, velocity));
  const Force3 force = rub(stretch, sliding, surface, surface.friction * wall_newton);
  contact.stuck_at = input.tip - stretch;
  return force;
}

bool GhostPointArm::was_pressed_lately(const Contact& contact, MonotonicTime now) const noexcept {
  return contact.has_pressed && now - contact.last_pressed <= settings_.redetection_guard;
}

// What teleop.md 2(e) grants the coordinate spring in one touch, and no more (decision 0057). A
// face that is found again within the guard has its old touch to thank for what the spring gave.
void GhostPointArm::update_spring_budget(MonotonicTime now) noexcept {
  const auto is_pressing = [](const Contact& contact) { return contact.is_pressing; };
  const auto is_recent = [&](const Contact& contact) { return was_pressed_lately(contact, now); };
  const double offset_m2 = symmetric_dot(frame_.offset(), frame_.offset());
  const bool is_touching = std::any_of(contacts_.begin(), contacts_.end(), is_pressing);
  touch_offset_m2_ = is_touching ? std::max(touch_offset_m2_, offset_m2) : offset_m2;
  if (std::none_of(contacts_.begin(), contacts_.end(), is_recent)) spring_spent_joule_ = 0;
}

bool GhostPointArm::goes_on_pressing(const Contact& contact) const noexcept {
  return contact.is_held && contact.is_pressing &&
         depth_m(contact.plane, last_hand_) > contact.spring.gap_m();
}

// A spring that grows under a finger that presses gives the hand the growth times the depth; a
// finger deeper than half of the offset would get more than the shift stored. What the faces want
// beyond the budget is taken from each by its share: none of them comes first (decision 0479).
void GhostPointArm::raise_springs(Duration dt) noexcept {
  double wanted_joule = 0;
  int wishes = 0;
  for (Contact& contact : contacts_) {
    if (!goes_on_pressing(contact)) continue;
    contact.ramp_elapsed_s += std::max(0.0, seconds(dt));
    const double joule = price_joule(contact, rise_m(contact, dt));
    wanted_joule += joule;
    if (joule > 0) ++wishes;
  }
  if (wishes > 2) wanted_joule = sum_of_prices_joule(dt);
  const double granted_joule = std::max(
      0.0, settings_.coordinate_spring.newton_per_m * touch_offset_m2_ / 2 - spring_spent_joule_);
  const double share = wanted_joule > granted_joule ? granted_joule / wanted_joule : 1;
  for (Contact& contact : contacts_) {
    if (!goes_on_pressing(contact)) continue;
    const double by_m = rise_m(contact, dt);
    contact.shown_m += by_m > 0 ? share * by_m : by_m;
  }
  spring_spent_joule_ += share * wanted_joule;
}

double GhostPointArm::price_joule(const Contact& contact, double by_m) const noexcept {
  return std::max(0.0, by_m) * settings_.coordinate_spring.newton_per_m *
         depth_m(contact.plane, last_hand_);
}

// In order of size: the same bits in whatever order the faces are told.
double GhostPointArm::sum_of_prices_joule(Duration dt) const noexcept {
  rt::StaticVector<double, kMaxContacts> prices_joule;
  for (const Contact& contact : contacts_) {
    if (goes_on_pressing(contact))
      prices_joule.push_back(price_joule(contact, rise_m(contact, dt)));
  }
  std::sort(prices_joule.begin(), prices_joule.end());
  double sum_joule = 0;
  for (const double joule : prices_joule) sum_joule += joule;
  return sum_joule;
}

// By how much its spring would grow in a step that its ramp knows of. Only a frame that was pushed
// away along the normal pulls back; one displaced the other way would draw the finger into the
// wall.
double GhostPointArm::rise_m(const Contact& contact, Duration dt) const noexcept {
  const double target_m = std::max(0.0, -dot(contact.plane.normal, frame_.offset()));
  const double ramp_s = seconds(settings_.coordinate_spring_ramp);
  const double share = ramp_s > 0 ? std::min(1.0, contact.ramp_elapsed_s / ramp_s) : 1.0;
  const double wanted_m = contact.ramp_from_m + (target_m - contact.ramp_from_m) * share;
  const double by_m = wanted_m - contact.shown_m;
  // What waited for the budget comes as slowly as what did not.
  return ramp_s > 0 ? std::min(by_m, target_m * std::max(0.0, seconds(dt)) / ramp_s) : by_m;
}

}  // namespace thimble::coupling
