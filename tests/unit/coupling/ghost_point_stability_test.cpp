#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "daemon/coupling/ghost_point_arm.hpp"
#include "hand_on_arm.hpp"

namespace thimble::coupling {
namespace {

using testing::HandOnArm;
using testing::Pace;
using testing::Reference;

struct Course {
  double swing_m{0};  // peak to peak while the hand holds
  double peak_newton{0};
  double largest_offset_m{0};
  std::uint64_t offset_events{0};
  double generated_joule{0};
};

// The approach, hold and retreat of Reference, `rounds` times.
Course push(int delay_ms, Pace pace, int rounds = 1) {
  GhostPointArm arm{GhostPointSettings{}};
  HandOnArm hand(arm, std::chrono::milliseconds(delay_ms), pace, -0.015);
  Course course;
  double least_m = 1;
  double most_m = -1;
  Reference reference;
  for (int i = 0; i < rounds * Reference::kTicks; ++i) {
    const int tick = i % Reference::kTicks;
    reference.advance(tick);
    const ArmOutput out = hand.tick(reference.x_m, reference.v_m_per_s);
    course.peak_newton = std::max(course.peak_newton, std::abs(out.force.x));
    course.largest_offset_m = std::max(course.largest_offset_m, norm(out.offset));
    if (tick < Reference::kHoldFrom_tick || i >= Reference::kHoldTo_tick) continue;
    least_m = std::min(least_m, hand.x_m());
    most_m = std::max(most_m, hand.x_m());
  }
  course.swing_m = most_m - least_m;
  course.offset_events = arm.counters().offset_events;
  course.generated_joule = hand.energy().generated_joule();
  return course;
}

// teleop.md 5, gate G1.
TEST(GhostPointStability, HandHoldsStillAtAnyDelay) {
  for (const Pace pace : {Pace::Streamed, Pace::LockStep}) {
    for (const int delay_ms : {1, 2, 5, 10, 20, 50, 100, 150, 200, 300, 400, 500}) {
      const Course course = push(delay_ms, pace);
      EXPECT_LT(course.swing_m, 0.0005) << delay_ms << " ms";
      EXPECT_LT(course.peak_newton, 8.5) << delay_ms << " ms";
    }
  }
}

TEST(GhostPointStability, ShortDelaysHoldAsHardAsNone) {
  EXPECT_NEAR(push(1, Pace::Streamed).peak_newton, 3.9, 0.2);
}

// teleop.md 2(e): E_gen <= N·K·H²/2 + k_o·o_max²/2, over five touches.
TEST(GhostPointStability, GeneratedEnergyStaysWithinItsBound) {
  for (const Pace pace : {Pace::Streamed, Pace::LockStep}) {
    for (const int delay_ms : {1, 20, 100, 200, 500}) {
      const Course course = push(delay_ms, pace, 5);
      const double events_joule =
          static_cast<double>(course.offset_events) * 0.5 * 800 * 0.0005 * 0.0005;
      const double spring_joule = 0.5 * 50 * course.largest_offset_m * course.largest_offset_m;
      EXPECT_LE(course.generated_joule, events_joule + spring_joule + 1e-9) << delay_ms << " ms";
    }
  }
}

}  // namespace
}  // namespace thimble::coupling
