#pragma once

#include <vector>

#include "daemon/coupling/ghost_point_arm.hpp"
#include "hand_samples.hpp"

namespace thimble::coupling::testing {

inline constexpr Direction3 kPlusX{1, 0, 0};
inline constexpr Direction3 kMinusX{-1, 0, 0};
inline constexpr Direction3 kPlusY{0, 1, 0};

inline ConstraintPlane wall(Direction3 normal, double offset_m) {
  return {.normal = normal, .offset_m = offset_m, .surface = {}};
}

// The coordinate spring would add to the wall's force.
inline GhostPointSettings without_spring() {
  GhostPointSettings settings;
  settings.coordinate_spring = {0};
  return settings;
}

// An arm half with its hand on a bench: each call is one tick of 1 ms.
template <class Arm, class Settings>
class BenchOf {
 public:
  explicit BenchOf(const Settings& settings = {}) : sut(settings) { sut.reset(now, {}); }

  // A tick with a reply that says `planes`.
  ArmOutput told(Position3 tip, const std::vector<ConstraintPlane>& planes,
                 Velocity3 velocity = {}) {
    ConstraintSet set;
    set.sequence = ++replies;
    set.session = session;
    for (const ConstraintPlane& plane : planes) set.planes.push_back(plane);
    return tick(tip, velocity, &set);
  }
  // A tick without a reply.
  ArmOutput alone(Position3 tip, Velocity3 velocity = {}) { return tick(tip, velocity, nullptr); }

  Arm sut;
  MonotonicTime now{};
  LinkQuality link{.is_up = true};
  std::uint32_t session{1};
  std::uint64_t replies{0};

 private:
  ArmOutput tick(Position3 tip, Velocity3 velocity, const ConstraintSet* fresh) {
    now = now + kTick;
    return sut.step({.now = now,
                     .dt = kTick,
                     .tip = tip,
                     .tip_velocity = velocity,
                     .buttons = 0,
                     .fresh = fresh,
                     .link = link});
  }
};
using ArmBench = BenchOf<GhostPointArm, GhostPointSettings>;

}  // namespace thimble::coupling::testing
