#include "sim/model/falcon/delta_linkage.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sim/model/arm/sine_cosine.hpp"

namespace thimble::sim {
namespace {

constexpr int kMostIterations = 30;
constexpr double kLongestStep_m = 0.01;
// Of G in each leg: less than 1e-12 m from where it is 0; rounding leaves a ten-thousandth of it.
constexpr double kFits_m2 = 1e-13;
constexpr double kSingular = 1e-10;  // m³ of det A, which is 1e-3 where the arm works

double square(double value) noexcept { return value * value; }

}  // namespace

DeltaLinkage::DeltaLinkage(const FalconParameters& parameters) : p_(parameters) {
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    const double sine = std::sin(p_.azimuth_rad[i]);
    const double cosine = std::cos(p_.azimuth_rad[i]);
    legs_[i] = {{cosine, sine, 0}, {-sine, cosine, 0}};
  }
}

DeltaLinkage::Cranks DeltaLinkage::cranks(const Triple& q) noexcept {
  return {{std::sin(q.x), std::sin(q.y), std::sin(q.z)},
          {std::cos(q.x), std::cos(q.y), std::cos(q.z)}};
}

DeltaLinkage::Cranks DeltaLinkage::turned(const Cranks& from, const Triple& step_rad) noexcept {
  Cranks to{};
  for (std::size_t i = 0; i < 3; ++i) {
    const SineCosine end =
        SineCosine{from.sine[i], from.cosine[i]}.after(sine_cosine_of(step_rad[i]));
    to.sine[i] = end.sine;
    to.cosine[i] = end.cosine;
  }
  return to;
}

DeltaLinkage::Reach DeltaLinkage::reach(std::size_t leg, const Cranks& cranks,
                                        const Triple& x) const noexcept {
  const double out_m = dot(legs_[leg].outward, x) - p_.base_radius_m + p_.grip_radius_m;
  Reach r{out_m - p_.crank_m * cranks.cosine[leg], x.z - p_.crank_m * cranks.sine[leg], 0,
          dot(legs_[leg].across, x) - p_.base_shift_m + p_.grip_shift_m};
  r.length_m = std::sqrt(square(r.out_m) + square(r.up_m));
  return r;
}

DeltaLinkage::Constraint DeltaLinkage::constrain(const Cranks& cranks,
                                                 const Triple& x) const noexcept {
  Constraint c;
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    const Reach r = reach(i, cranks, x);
    c.reach[i] = r;
    const double span_m = r.length_m - p_.rods_to_links_m;
    const double pull = r.length_m > 0 ? span_m / r.length_m : 0;
    c.value[i] = (square(span_m) + square(r.across_m) - square(p_.rods_m)) / 2;
    const Triple by_grip = pull * (r.out_m * legs_[i].outward + r.up_m * Triple{0, 0, 1}) +
                           r.across_m * legs_[i].across;
    c.a.row[i] = {by_grip.x, by_grip.y, by_grip.z};
    c.b[i] = pull * p_.crank_m * (r.out_m * cranks.sine[i] - r.up_m * cranks.cosine[i]);
  }
  return c;
}

Triple DeltaLinkage::bias(const Cranks& cranks, const Constraint& at, const Triple& rate,
                          const Triple& velocity) const noexcept {
  Triple h;
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    const Reach& r = at.reach[i];
    const double sine = cranks.sine[i];
    const double cosine = cranks.cosine[i];
    const double knee_m_per_s = p_.crank_m * rate[i];
    const double out = dot(legs_[i].outward, velocity) + knee_m_per_s * sine;
    const double up = velocity.z - knee_m_per_s * cosine;
    const double turning = p_.crank_m * square(rate[i]);  // of the knee, towards its axis
    const double growth = (r.out_m * out + r.up_m * up) / r.length_m;
    const double growth_rate =
        (square(out) + square(up) + turning * (r.out_m * cosine + r.up_m * sine) - square(growth)) /
        r.length_m;
    h[i] = square(growth) + (r.length_m - p_.rods_to_links_m) * growth_rate +
           square(dot(legs_[i].across, velocity));
  }
  return h;
}

std::optional<Triple> DeltaLinkage::inverse(const Triple& x) const noexcept {
  Triple q;
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    // From the crank's axis itself: a crank of no length.
    const double out_m = dot(legs_[i].outward, x) - p_.base_radius_m + p_.grip_radius_m;
    const double across_m = dot(legs_[i].across, x) - p_.base_shift_m + p_.grip_shift_m;
    const double span2_m2 = square(p_.rods_m) - square(across_m);
    if (!(span2_m2 > 0)) return std::nullopt;
    const double reach_m = p_.rods_to_links_m + std::sqrt(span2_m2);
    const double far_m = std::hypot(out_m, x.z);
    const double cosine =
        (square(p_.crank_m) + square(far_m) - square(reach_m)) / (2 * p_.crank_m * far_m);
    if (!(std::abs(cosine) <= 1)) return std::nullopt;
    q[i] = std::atan2(x.z, out_m) - std::acos(cosine);
  }
  return q;
}

std::optional<DeltaLinkage::Pose> DeltaLinkage::forward(const Cranks& cranks,
                                                        const Triple& near) const noexcept {
  Pose pose{cranks, near, {}, {}};
  for (int i = 0; i < kMostIterations; ++i) {
    pose.constraint = constrain(cranks, pose.x);
    const double determinant = determinant_of(pose.constraint.a);
    if (!(std::abs(determinant) > kSingular)) return std::nullopt;
    pose.a_inverse = inverse_of(pose.constraint.a, determinant);
    const Triple& off_m2 = pose.constraint.value;
    if (std::max({std::abs(off_m2.x), std::abs(off_m2.y), std::abs(off_m2.z)}) < kFits_m2) {
      return pose;
    }
    Triple step = times(pose.a_inverse, off_m2);
    const double length_m = norm(step);
    if (length_m > kLongestStep_m) step = kLongestStep_m / length_m * step;
    pose.x -= step;
  }
  return std::nullopt;
}

}  // namespace thimble::sim
