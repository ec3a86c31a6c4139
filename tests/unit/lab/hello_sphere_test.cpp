#include "lab/hello_sphere/hello_sphere.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lab/hello_sphere/touch.hpp"

namespace thimble::lab {
namespace {

Touch touch_of(coupling::Scheme scheme, Gesture gesture, double delay_s) {
  auto touch = touch_ball({.name = "tested", .scheme = scheme}, gesture, delay_s);
  EXPECT_TRUE(touch) << touch.error().message;
  return touch.value_or(Touch{});
}

// Two springs in series, 200 and 800 N/m, over 10 mm.
TEST(HelloSphereTouch, WithoutDelayTheFingerHoldsWhatItsSpringAndTheBallsAgreeOn) {
  const Held rest = held(touch_of(coupling::Scheme::GhostPoint, Gesture::Press, 0));
  EXPECT_NEAR(rest.mean_newton, 1.6, 0.05);
  EXPECT_LT(rest.swing_m, 1e-5);
  EXPECT_EQ(rest.swing_hz, 0);
}

TEST(HelloSphereTouch, ForcesThatComeBackLateThrowTheFingerAndPlanesDoNot) {
  using coupling::Scheme;
  EXPECT_LT(held(touch_of(Scheme::RemoteForce, Gesture::Press, 0.001)).swing_m, 1e-4);
  const Touch thrown = touch_of(Scheme::RemoteForce, Gesture::Press, 0.02);
  const Held swing = held(thrown);
  EXPECT_GT(swing.swing_m, 0.005);
  EXPECT_GT(thrown.generated_joule, 0.01);
  // Slower than the delay's own frequency, faster than the finger alone (5.8 Hz).
  EXPECT_GT(swing.swing_hz, 2);
  EXPECT_LT(swing.swing_hz, 1 / (2 * 0.02));
  for (const Scheme scheme : {Scheme::GhostPoint, Scheme::ConstraintPlane, Scheme::Wave}) {
    const Touch calm = touch_of(scheme, Gesture::Press, 0.02);
    EXPECT_LT(held(calm).swing_m, 5e-4);
    EXPECT_LT(calm.generated_joule, 2e-3);
  }
}

TEST(HelloSphereTouch, AStrokeWithoutDelayFollowsTheBall) {
  const Touch stroke = touch_of(coupling::Scheme::GhostPoint, Gesture::Stroke, 0);
  double highest_m = -1;
  for (const TouchTick& tick : stroke.ticks) {
    highest_m = std::max(highest_m, tick.tip.y);
    const double out_m = std::hypot(tick.tip.x, tick.tip.y - kBallCenter_m);
    EXPECT_GT(out_m, kBall_m - 0.008) << "no deeper than 8 N press it: 800 N/m";
  }
  EXPECT_GT(highest_m, kBallTop_m - 0.004);
  EXPECT_EQ(distance_m(stroke, stroke), 0);
  const Touch late = touch_of(coupling::Scheme::GhostPoint, Gesture::Stroke, 0.05);
  EXPECT_GT(distance_m(stroke, late), 1e-4);
}

TEST(HelloSphere, FindsWhatTheThesisTellsOf) {
  const auto findings = run_hello_sphere({});
  ASSERT_TRUE(findings) << findings.error().message;
  EXPECT_TRUE(findings->is_met()) << tell(*findings);
  EXPECT_EQ(findings->tables[0].rows.size(), 6U * 8U);
  EXPECT_EQ(tell(*run_hello_sphere({})), tell(*findings));
}

}  // namespace
}  // namespace thimble::lab
