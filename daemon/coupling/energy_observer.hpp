#pragma once

#include <algorithm>
#include <cmath>

#include "daemon/world/push_out.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Adds up the work done at one port: positive is energy given to the hand. What a passive
// wall gives back it was given before, so the largest sum ever seen is energy generated.
// E = sum of F·v·dt. SOURCE: Hannaford and Ryu, their observer (docs/references.md), the sign
// turned.
//
// Thread: its owner's. RT: add() THIMBLE_RT. Units: N, m/s, J. Errors: none.
class EnergyObserver {
 public:
  THIMBLE_RT void add(Force3 on_hand, Velocity3 of_hand, Duration dt) noexcept {
    add_joule(dot(on_hand, of_hand) * seconds(dt));
  }
  // What is not finite is none.
  THIMBLE_RT void add_joule(double work_joule) noexcept {
    if (!std::isfinite(work_joule)) return;
    given_joule_ += work_joule;
    generated_joule_ = std::max(generated_joule_, given_joule_);
  }
  [[nodiscard]] double given_joule() const noexcept { return given_joule_; }
  [[nodiscard]] double generated_joule() const noexcept { return generated_joule_; }

 private:
  double given_joule_{0};
  double generated_joule_{0};
};

// The same by places: each force is held until the tip has moved on.
// E(k) = sum of F(j)·(p(j+1) − p(j)), j < k: what F·v·dt adds up to when v is the true mean
// velocity, so that no error of a filter adds up.
//
// Axes are added in order of size: permuted ones give the same bits. What is not finite moves
// nothing: such a force is none, and such a place is left out.
//
// Thread: its owner's. RT: THIMBLE_RT. Frame: any, both in the same. Units: N, m, J. Errors: none.
class PortObserver {
 public:
  THIMBLE_RT void reset(Position3 tip) noexcept {
    energy_ = {};
    held_ = {};
    if (is_finite(tip)) tip_ = tip;
  }
  // `held`: from now on, the tip being at `tip`.
  THIMBLE_RT void observe(Position3 tip, Force3 held) noexcept {
    if (!is_finite(tip) || !is_finite(held)) {
      held_ = {};
      return;
    }
    energy_.add_joule(work_joule(tip));
    tip_ = tip;
    held_ = held;
  }
  // Of the force that is held: what it gives until the tip is at `tip`.
  [[nodiscard]] THIMBLE_RT double work_joule(Position3 tip) const noexcept {
    const Displacement3 moved = tip - tip_;
    return world::symmetric_sum(held_.x * moved.x, held_.y * moved.y, held_.z * moved.z);
  }
  [[nodiscard]] double given_joule() const noexcept { return energy_.given_joule(); }
  [[nodiscard]] double generated_joule() const noexcept { return energy_.generated_joule(); }

 private:
  EnergyObserver energy_{};
  Force3 held_{};
  Position3 tip_{};
};

}  // namespace thimble::coupling
