#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "tests/support/arm_watch.hpp"
#include "tests/support/guided_hand.hpp"

// "Hello, sphere" (thesis 3.2) in closed loop: what a finger feels beside what geometry says.
namespace thimble {
namespace {

using test::ClosedLoop;

constexpr Position3 kCenter{0, -0.025, 0};
constexpr double kFloor_m = -0.045;

std::string configuration() {
  return R"(
[[arm]]
name = "right"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
world = "hello"
[arm.hand]
motion = "still"
[[world]]
name = "hello"
source = "sphere"
)";
}

Position3 felt_at(const servo::ServoFrame& frame) { return frame.tip + frame.offset; }

double angle_deg(Force3 force, Displacement3 outward) {
  const double cosine = dot(force, outward) / (norm(force) * norm(outward));
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

class HelloSphere : public ::testing::Test {
 protected:
  HelloSphere() { loop.run_until_driven(); }
  void go(test::GuidedHand& hand, Position3 to) {
    hand.go(to, [this] { watch.see(); });
    EXPECT_EQ(watch.breach(), "");
    EXPECT_EQ(loop.snapshot().faults, 0U);
  }
  // A steady push outwards from the centre, to a hundredth of a degree, as hard as it is deep.
  void expect_pushed_off_the_ball(double sign) {
    const servo::ServoFrame& frame = loop.frame();
    const Displacement3 out = felt_at(frame) - kCenter;
    EXPECT_TRUE(frame.is_in_contact);
    EXPECT_GT(norm(frame.wish), 0.5);
    EXPECT_LT(angle_deg(frame.wish, sign * out), 0.01);
    const double depth_m = 0.02 - norm(out);
    EXPECT_NEAR(norm(frame.wish), 800 * depth_m, 0.05 * 800 * depth_m + 0.1);
  }

  ClosedLoop loop{{}, {configuration(), {}, {}}};
  test::ArmWatch watch{loop};
};

TEST_F(HelloSphere, NothingHoldsAHandAboveIt) {
  test::GuidedHand hand(loop);
  go(hand, {0.01, 0, 0.01});
  EXPECT_FALSE(loop.frame().is_in_contact);
  EXPECT_EQ(norm(loop.frame().wish), 0);
}

TEST_F(HelloSphere, PushedOnTopItPushesUp) {
  test::GuidedHand hand(loop);
  go(hand, {0, -0.009, 0});
  expect_pushed_off_the_ball(1);
  EXPECT_GT(loop.frame().wish.y, 0.99 * norm(loop.frame().wish));
}

TEST_F(HelloSphere, PushedFromAnySideItPushesAlongTheNormalThere) {
  test::GuidedHand hand(loop);
  go(hand, {0.035, 0, 0});
  go(hand, {0.035, -0.025, 0});
  go(hand, {0.0165, -0.025, 0});
  expect_pushed_off_the_ball(1);
  go(hand, {0.035, -0.025, 0.01});
  go(hand, {0.014, -0.02, 0.008});
  expect_pushed_off_the_ball(1);
}

TEST_F(HelloSphere, BesideItTheFloorPushesStraightUp) {
  test::GuidedHand hand(loop);
  go(hand, {0.04, 0, 0});
  go(hand, {0.035, kFloor_m - 0.004, 0.01});
  const Force3 wish = loop.frame().wish;
  EXPECT_GT(wish.y, 1);
  EXPECT_EQ(wish.x, 0);
  EXPECT_EQ(wish.z, 0);
}

TEST_F(HelloSphere, InTheGapBelowItBallAndFloorPushEachTheirWay) {
  test::GuidedHand hand(loop);
  go(hand, {0.04, 0, 0});
  go(hand, {0.04, -0.0435, 0});
  go(hand, {0.014, -0.0435, 0});
  EXPECT_EQ(norm(loop.frame().wish), 0) << "there is room for a finger";
  go(hand, {0.0135, -0.0375, 0});
  expect_pushed_off_the_ball(1);
  EXPECT_LT(loop.frame().wish.y, -0.5) << "down: the ball is above";
  go(hand, {0.0135, kFloor_m - 0.003, 0});
  EXPECT_GT(loop.frame().wish.y, 0.5);
  EXPECT_EQ(loop.frame().wish.x, 0);
}

// Stroked over, its face is that of the newest answer: older than the hand by the round trip.
struct Stroke {
  double worst_deg{0};
  double mean_deg{0};
  double peak_newton{0};
  std::string breach;
};

Stroke stroke(const char* delay) {
  ClosedLoop loop({std::string("arm.impairment.delay_s=") + delay}, {configuration(), {}, {}});
  loop.run_until_driven();
  test::ArmWatch watch(loop);
  test::GuidedHand hand(loop);
  hand.go({-0.012, -0.003, 0});
  Stroke out;
  int felt = 0;
  const auto see = [&] {
    watch.see();
    const servo::ServoFrame& frame = loop.frame();
    if (norm(frame.wish) < 0.3) return;
    const double off_deg = angle_deg(frame.wish, felt_at(frame) - kCenter);
    out.worst_deg = std::max(out.worst_deg, off_deg);
    out.mean_deg += off_deg;
    ++felt;
    out.peak_newton = std::max(out.peak_newton, norm(frame.wish));
  };
  hand.go({-0.012, -0.011, 0}, see);
  hand.go({0.012, -0.0065, 0}, see);
  hand.go({0, -0.0065, 0.01}, see);
  EXPECT_GT(felt, 200);
  out.mean_deg /= felt;
  out.breach = watch.breach();
  std::printf("stroked at 0.1 m/s, %s s of delay: normal off by %.2f degrees, at most %.2f\n",
              delay, out.mean_deg, out.worst_deg);
  return out;
}

TEST(HelloSphereStroked, TheNormalLagsByTheWayOfOneRoundTrip) {
  const Stroke near = stroke("0");
  EXPECT_EQ(near.breach, "");
  EXPECT_LT(near.worst_deg, 1.0);
  const Stroke far = stroke("0.05");
  EXPECT_EQ(far.breach, "");
  EXPECT_GT(far.worst_deg, near.worst_deg);
  // 0.1 m/s for 50 ms is 5 mm, at 16 mm from the centre and more.
  EXPECT_LT(far.worst_deg, 20.0);
}

TEST(HelloSphereExplored, APersonFeelsItNearAndFar) {
  for (const char* delay : {"0", "0.05", "0.1"}) {
    ClosedLoop loop({"arm.hand.motion=explore", "arm.hand.reach_m=0.03",
                     std::string("arm.impairment.delay_s=") + delay},
                    {configuration(), {}, {}});
    test::ArmWatch watch(loop);
    loop.run(20, [&] { watch.see(); });
    EXPECT_EQ(watch.breach(), "") << delay;
    EXPECT_EQ(loop.snapshot().faults, 0U);
    EXPECT_GT(loop.snapshot().total_contacts, 3U) << delay;
    EXPECT_GT(loop.snapshot().peak_force_newton, 0.3) << delay;
  }
}

}  // namespace
}  // namespace thimble
