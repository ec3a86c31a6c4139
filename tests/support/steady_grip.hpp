#pragma once

#include "hal/plugin/arm_backend.hpp"

namespace thimble::test {

// A hand that holds the tip of a simulated arm at a place: stiff and damped enough that the tip is
// there, soft enough for the plant's step. Ours. SI, base frame.
class SteadyGrip final : public plugin::TipLoad {
 public:
  Force3 force_on_tip(MonotonicTime, Duration, Position3 tip,
                      Velocity3 velocity) noexcept override {
    return Stiffness{800} * (place - tip) - Damping{15} * velocity;
  }
  [[nodiscard]] bool is_button_pressed(MonotonicTime) const noexcept override { return is_pressed; }
  // A fiftieth of the way at once; the hand is there after 400 of them.
  void creep_to(Position3 there) noexcept { place = place + 0.02 * (there - place); }

  Position3 place;
  bool is_pressed{false};
};

}  // namespace thimble::test
