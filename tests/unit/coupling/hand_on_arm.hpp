#pragma once

#include "delayed_loop.hpp"
#include "fake_box.hpp"
#include "finger.hpp"

namespace thimble::coupling::testing {

// A finger on an arm, in the plainest box there is.
class HandOnArm {
 public:
  HandOnArm(ArmCoupling& arm, Duration delay, Pace pace, double start_m)
      : box_(0.015), loop_(arm, box_, Finger::kServo, delay, pace), finger_(start_m) {}
  // In another world than the box, from its origin.
  HandOnArm(ArmCoupling& arm, std::unique_ptr<WorldCoupling> world, Duration delay)
      : box_(0), loop_(arm, std::move(world), Finger::kServo, delay, Pace::Streamed), finger_(0) {}

  // One servo tick with the finger drawn to `reference_m`, moving at `reference_m_per_s`.
  ArmOutput tick(double reference_m, double reference_m_per_s) {
    const Finger::Sight seen = finger_.look();
    const ArmOutput output = loop_.tick({seen.x_m, 0, 0}, {seen.v_m_per_s, 0, 0});
    finger_.move(reference_m, reference_m_per_s, output.force.x);
    return output;
  }

  [[nodiscard]] double x_m() const { return finger_.x_m(); }
  [[nodiscard]] const EnergyObserver& energy() const { return finger_.energy(); }

 private:
  FakeBox box_;
  DelayedLoop loop_;
  Finger finger_;
};

}  // namespace thimble::coupling::testing
