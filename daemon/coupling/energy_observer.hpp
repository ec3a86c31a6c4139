#pragma once

#include <algorithm>

#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Adds up the work done at one port: positive is energy given to the hand. What a passive
// wall gives back it was given before, so the largest sum ever seen is energy generated.
// E = sum of F·v·dt.
//
// Thread: its owner's. RT: add() THIMBLE_RT. Units: J.
class EnergyObserver {
 public:
  THIMBLE_RT void add(Force3 on_hand, Velocity3 of_hand, Duration dt) noexcept {
    given_joule_ += dot(on_hand, of_hand) * seconds(dt);
    generated_joule_ = std::max(generated_joule_, given_joule_);
  }
  [[nodiscard]] double given_joule() const noexcept { return given_joule_; }
  [[nodiscard]] double generated_joule() const noexcept { return generated_joule_; }

 private:
  double given_joule_{0};
  double generated_joule_{0};
};

}  // namespace thimble::coupling
