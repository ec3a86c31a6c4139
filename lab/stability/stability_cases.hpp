#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lab/stability/largest.hpp"
#include "lab/stability/release.hpp"

namespace thimble::lab {

enum class Theory {
  RemoteForce,    // short_delay_limit_newton_per_m(), any_delay_limit()
  WorldEnd,       // world_end_limit_newton_per_m()
  BothEnds,       // both_ends_limit_newton_per_m()
  Passive,        // waves: stable however stiff
  DeviceLimited,  // short_delay_limit_newton_per_m() without the delay
  NoDelay,        // of walls that are rendered here, but not by the formula: the same at any delay
};

// A scheme whose stiffness is raised until it swings.
struct StabilityCase {
  std::string name;
  Theory theory{Theory::Passive};
  // Of hand and arm.
  double damping_newton_s_per_m{0};
  // What the scheme takes at most.
  double ceiling_newton_per_m{0};
  // The scheme, so stiff: the wall as it renders it or as its far end does, or the spring between
  // hand and slave.
  std::function<Release(double newton_per_m)> with;
  // A spring between hand and slave must not swing in free space either.
  bool has_slave{false};

  // N/m. Of Passive the ceiling; of NoDelay that of DeviceLimited.
  [[nodiscard]] double theory_newton_per_m(double delay_s) const;
  [[nodiscard]] Result<bool> is_stable(double newton_per_m, double delay_s) const;
  [[nodiscard]] Result<Largest> find_largest(double delay_s) const;
};

// SOURCE of the hand's mass and dampings: teleop.md 2(a); of b of the waves: its section 3.
inline constexpr double kHand_kg = 0.15;
// Ours: a wall that is learned of late pushes the hand by K·H at first (teleop.md 2(e)); who leans
// with less is thrown off, and taps instead of leaning.
inline constexpr double kLean_newton = 4;
[[nodiscard]] std::vector<StabilityCase> stability_cases();

}  // namespace thimble::lab
