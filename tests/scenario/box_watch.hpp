#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "tests/support/arm_watch.hpp"

namespace thimble::test {

// A watch for worlds whose free room is convex about the origin: no wall may ever pull.
// Adds up the work that the motors do on the hand at the arm, from one touch to the next: what
// a wall gives back it was given before, so any sum above zero is energy that it made.
class BoxWatch {
 public:
  explicit BoxWatch(ClosedLoop& loop) : loop_(&loop), arm_(loop) {}

  void see() {
    arm_.see();
    const servo::ServoFrame& frame = loop_->frame();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double q_m = frame.tip[axis] + frame.offset[axis];
      if (frame.wish[axis] * q_m > 1e-12) ++pulls_;
    }
    see_energy(frame, loop_->truth());
  }

  [[nodiscard]] const std::string& breach() const noexcept { return arm_.breach(); }
  [[nodiscard]] int pulls() const noexcept { return pulls_; }
  // Most that any touch made.
  [[nodiscard]] double generated_j() const noexcept { return generated_j_; }
  // Most that any touch made beyond what the ghost point may: for each contact the wall that is
  // H deep at once, and what the coordinate spring stores in the offset (daemon/coupling).
  [[nodiscard]] double excess_j() const noexcept { return excess_j_; }
  [[nodiscard]] const ArmWatch& arm() const noexcept { return arm_; }

 private:
  static constexpr double kStiffness = 800;        // N/m
  static constexpr double kHysteresis_m = 0.0005;  // of cells of 2 mm and more
  static constexpr double kCoordinateSpring = 50;  // N/m

  void see_energy(const servo::ServoFrame& frame, const plugin::ArmTruth& truth) {
    if (norm(truth.motor_force) == 0) {
      given_j_ = 0;
      contacts_before_ = frame.contacts;
      offset_m_ = 0;
    }
    given_j_ += dot(truth.motor_force, truth.tip_velocity) * seconds(frame.dt);
    offset_m_ = std::max(offset_m_, norm(frame.offset));
    const double contacts = frame.contacts - contacts_before_;
    const double allowed_j = contacts * 0.5 * kStiffness * kHysteresis_m * kHysteresis_m +
                             0.5 * kCoordinateSpring * offset_m_ * offset_m_;
    generated_j_ = std::max(generated_j_, given_j_);
    excess_j_ = std::max(excess_j_, given_j_ - allowed_j);
  }

  ClosedLoop* loop_;
  ArmWatch arm_;
  int pulls_{0};
  double given_j_{0};
  std::uint32_t contacts_before_{0};
  double offset_m_{0};
  double generated_j_{0};
  double excess_j_{0};
};

}  // namespace thimble::test
