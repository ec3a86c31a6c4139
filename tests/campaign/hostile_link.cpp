#include "tests/campaign/hostile_link.hpp"

#include <limits>

namespace thimble::campaign {
namespace {

using Limits = std::numeric_limits<double>;

constexpr std::array kAbsurd{Limits::quiet_NaN(),
                             Limits::infinity(),
                             -Limits::infinity(),
                             Limits::max(),
                             -Limits::max(),
                             Limits::denorm_min(),
                             0.0,
                             -0.0,
                             -1.0,
                             1e9,
                             -1e9,
                             1e-300};

}  // namespace

void HostileLink::send(const coupling::HandSample& sample) noexcept {
  hand_ = sample.hand;
  below_->send(sample);
}

bool HostileLink::receive(coupling::ConstraintSet& out) noexcept {
  const bool is_fresh = below_->receive(out);
  if (is_fresh) old_[kept_++ % old_.size()] = out;
  // Now and then something comes that nobody asked for.
  if (!dice_.chance(is_fresh ? 0.3 : 0.02)) return is_fresh;
  lie(out);
  return true;
}

void HostileLink::lie(coupling::ConstraintSet& set) noexcept {
  ++lies_;
  const std::uint64_t how = dice_.below(4);
  if (how == 0) set = old_[dice_.below(old_.size())];
  if (how == 1 || how == 2) invent_planes(set);
  if (how >= 2) renumber(set);
}

void HostileLink::invent_planes(coupling::ConstraintSet& set) noexcept {
  set.planes.clear();
  for (std::uint64_t left = dice_.below(coupling::kMaxPlanes + 1); left > 0; --left) {
    coupling::ConstraintPlane plane;
    plane.normal = some_normal();
    // About the hand: in front of it, or with the hand far within.
    plane.offset_m = dot(plane.normal, hand_) + some_number(-0.05, 0.05);
    plane.surface.stiffness = Stiffness{some_number(0, 5000)};
    plane.surface.damping = Damping{some_number(0, 50)};
    plane.surface.friction = some_number(0, 2);
    set.planes.push_back(plane);
  }
  set.has_ghost = dice_.chance(0.5);
  set.ghost = {some_number(-0.1, 0.1), some_number(-0.1, 0.1), some_number(-0.1, 0.1)};
  set.is_embedded = dice_.chance(0.5);
}

void HostileLink::renumber(coupling::ConstraintSet& set) noexcept {
  if (dice_.chance(0.5)) set.sequence = dice_.chance(0.5) ? dice_.bits() : 0;
  if (dice_.chance(0.5)) set.answers = dice_.chance(0.5) ? dice_.bits() : 0;
  if (dice_.chance(0.3)) set.session = static_cast<std::uint32_t>(dice_.bits());
  if (dice_.chance(0.3)) {
    set.sampled_at = {dice_.chance(0.5) ? Duration::max() : Duration::min()};
  }
}

double HostileLink::some_number(double low, double high) noexcept {
  return dice_.chance(0.25) ? kAbsurd[dice_.below(kAbsurd.size())] : dice_.uniform(low, high);
}

Direction3 HostileLink::some_normal() noexcept {
  const std::uint64_t how = dice_.below(4);
  if (how == 0) return {some_number(-2, 2), some_number(-2, 2), some_number(-2, 2)};
  Direction3 normal{dice_.uniform(-1, 1), dice_.uniform(-1, 1), dice_.uniform(-1, 1)};
  if (how == 1) normal = {0, 0, dice_.chance(0.5) ? 1.0 : -1.0};
  const double length = norm(normal);
  if (!(length > 0)) return {1, 0, 0};
  return {normal.x / length, normal.y / length, normal.z / length};
}

}  // namespace thimble::campaign
