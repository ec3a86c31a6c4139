#include "daemon/coupling/thesis_literal.hpp"

#include <cmath>
#include <cstddef>

namespace thimble::coupling {
namespace {

// Thesis appendix A, constants; the double literals are narrowed as the casts there do.
constexpr float kStiffness = static_cast<float>(0.8);          // N/mm
constexpr float kDamping = static_cast<float>(0.01);           // N·s/mm, unit inferred
constexpr float kCoordinateSpring = static_cast<float>(0.05);  // N/mm
constexpr float kHysteresis = static_cast<float>(0.5);         // mm
constexpr float kDeadBand = 4 * kHysteresis;
constexpr float kRelaxationStep = kHysteresis / 2;
constexpr std::uint8_t kRelaxationTicks = 10;
// As of the ghost point. Ours: the thesis has no bound, and a plane beyond what a float can say
// would make the frame infinite, for good.
constexpr double kMaxPlaneOffset_m = 1e6;

constexpr bool has_below(std::uint8_t directions, std::size_t axis) noexcept {
  return ((unsigned{directions} >> (2 * axis)) & 1U) != 0;
}
constexpr bool has_above(std::uint8_t directions, std::size_t axis) noexcept {
  return ((unsigned{directions} >> (2 * axis)) & 2U) != 0;
}

bool is_violated(const ThesisConstraint& constraint, std::size_t axis, float at_mm) noexcept {
  return (has_below(constraint.directions, axis) && at_mm > constraint.plane_mm[axis]) ||
         (has_above(constraint.directions, axis) && at_mm < constraint.plane_mm[axis]);
}

// Axis and direction bit of an axis-aligned normal; `axis` 3 when it is none.
struct Face {
  std::size_t axis{3};
  bool is_above{false};
};

Face face_of(const Direction3& normal) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Direction3 unit{};
    unit[axis] = 1;
    if (normal == unit) return {axis, false};
    if (normal == -unit) return {axis, true};
  }
  return {};
}

ThesisConstraint to_thesis(const PlaneList& planes) noexcept {
  ThesisConstraint constraint;
  for (const ConstraintPlane& plane : planes) {
    const Face face = face_of(plane.normal);
    if (face.axis == 3 || !(std::abs(plane.offset_m) <= kMaxPlaneOffset_m)) continue;
    if (has_below(constraint.directions, face.axis) ||
        has_above(constraint.directions, face.axis)) {
      continue;
    }
    const double at_m = face.is_above ? -plane.offset_m : plane.offset_m;
    constraint.plane_mm[face.axis] = static_cast<float>(1e3 * at_m);
    const unsigned bit = (face.is_above ? 2U : 1U) << (2 * face.axis);
    constraint.directions = static_cast<std::uint8_t>(constraint.directions | bit);
  }
  return constraint;
}

template <class Vector>
std::array<float, 3> to_milli(const Vector& si) noexcept {
  return {static_cast<float>(1e3 * si.x), static_cast<float>(1e3 * si.y),
          static_cast<float>(1e3 * si.z)};
}

template <class Vector>
Vector to_si(const std::array<float, 3>& milli) noexcept {
  return {1e-3 * static_cast<double>(milli[0]), 1e-3 * static_cast<double>(milli[1]),
          1e-3 * static_cast<double>(milli[2])};
}

}  // namespace

ThesisTick ThesisLiteralServo::step(const std::array<float, 3>& position_mm,
                                    const std::array<float, 3>& velocity_mm_per_s,
                                    ThesisConstraint& constraint) noexcept {
  if (is_first_) constraint = {};
  is_first_ = false;

  const auto fresh = static_cast<std::uint8_t>(constraint.directions & ~old_directions_);
  old_directions_ = constraint.directions;
  const bool is_relaxing_tick = ticks_modulo_10_ == 0;
  ticks_modulo_10_ = static_cast<std::uint8_t>((ticks_modulo_10_ + 1) % kRelaxationTicks);

  ThesisTick tick;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float& offset = offset_mm_[axis];
    const float plane = constraint.plane_mm[axis];
    const float position = position_mm[axis];
    const float before = position + offset;
    // Defect 1 lives here: the hysteresis has one sign for both directions.
    if ((has_below(fresh, axis) && before > plane + kHysteresis) ||
        (has_above(fresh, axis) && before + kHysteresis < plane)) {
      offset = plane - position + kHysteresis;
    }
    const float adjusted = position + offset;
    tick.adjusted_mm[axis] = adjusted;
    if (is_violated(constraint, axis, adjusted)) {
      // Adding to zero is no idle step: it turns a sum of -0 into +0.
      tick.force_newton[axis] =
          0.0F + (kStiffness * (plane - adjusted) - kDamping * velocity_mm_per_s[axis] +
                  kCoordinateSpring * offset);
    } else if (is_relaxing_tick && std::fabs(offset) > kDeadBand) {
      offset -= kRelaxationStep * (offset > 0 ? 1.0F : -1.0F);
    }
  }
  tick.offset_mm = offset_mm_;
  return tick;
}

void ThesisLiteralArm::restart(MonotonicTime now, Position3 /*tip*/) noexcept {
  ++restarts_;
  age_.restart(now);
  servo_ = {};
  constraint_ = {};
  applied_reply_ = 0;
  pressing_ = 0;
}

ArmOutput ThesisLiteralArm::advance(const ArmInput& input) noexcept {
  age_.update(input);
  if (input.fresh != nullptr) {
    constraint_ = to_thesis(input.fresh->planes);
    applied_reply_ = input.fresh->sequence;
  }
  if (age_.has_expired()) constraint_ = {};

  const ThesisTick tick =
      servo_.step(to_milli(input.tip), to_milli(input.tip_velocity), constraint_);
  ArmOutput output;
  count_contacts(tick, output);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    output.force[axis] = age_.gain() * static_cast<double>(tick.force_newton[axis]);
  }
  output.offset = to_si<Displacement3>(tick.offset_mm);
  output.is_frozen = age_.is_frozen();
  output.is_fading = age_.is_fading();
  output.sample = {.sequence = ++sequence_,
                   .sampled_at = input.now,
                   .hand = to_si<Position3>(tick.adjusted_mm),
                   .velocity = input.tip_velocity,
                   .buttons = input.buttons,
                   .applied_reply = applied_reply_,
                   .restart = restarts_};
  return output;
}

void ThesisLiteralArm::count_contacts(const ThesisTick& tick, ArmOutput& output) noexcept {
  unsigned pressing = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!is_violated(constraint_, axis, tick.adjusted_mm[axis])) continue;
    const unsigned bits = constraint_.directions & (3U << (2 * axis));
    if ((pressing_ & bits) == 0) ++output.new_contacts;
    pressing |= bits;
  }
  output.is_in_contact = pressing != 0;
  pressing_ = static_cast<std::uint8_t>(pressing);
}

}  // namespace thimble::coupling
