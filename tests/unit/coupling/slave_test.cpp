#include "daemon/coupling/slave.hpp"

#include <gtest/gtest.h>

#include "fake_box.hpp"
#include "hand_samples.hpp"

namespace thimble::coupling {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::FakeBox;
using testing::sample;

// A controller that pulls with 1 N along x and damps with 10 N·s/m.
Force3 pull(Position3 /*at*/, Velocity3 velocity, double /*step_s*/) {
  return {1 - 10 * velocity.x, -10 * velocity.y, -10 * velocity.z};
}

TEST(Slave, EndsWhereTheControllerAndTheWallAgreeHoweverTimePasses) {
  for (const Duration dt : {microseconds(125), microseconds(1000), microseconds(7300)}) {
    FakeBox box(0.015);
    Slave sut(box, {});
    ASSERT_TRUE(sut.open(sample(1, {})));
    for (Duration t{}; t < std::chrono::seconds(2); t += dt) ASSERT_TRUE(sut.advance(dt, pull));
    EXPECT_NEAR(sut.at().x, 0.015 + 1.0 / 800, 1e-6);
    EXPECT_NEAR(sut.wall_force().x, -1, 1e-3);
    EXPECT_NEAR(norm(sut.velocity()), 0, 1e-6);
  }
}

TEST(Slave, TakesItsProbeAlongOnceAMillisecondOfTheWorldsTime) {
  FakeBox box(0.015);
  Slave sut(box, {});
  ASSERT_TRUE(sut.open(sample(1, {})));
  (void)sut.advance(milliseconds(50), pull);
  EXPECT_EQ(box.moves, 50);
  (void)sut.advance(Duration::zero(), pull);
  EXPECT_EQ(box.moves, 50);
}

TEST(Slave, TellsThePressureThatIsOnIt) {
  FakeBox box(0.015);
  box.pressure = Force3{0, 0.25, 0};
  Slave sut(box, {});
  ASSERT_TRUE(sut.open(sample(1, {})));
  ConstraintSet set;
  sut.tell(sample(1, {}), set);
  EXPECT_FALSE(set.has_pressure) << "it has not looked around";
  ASSERT_TRUE(sut.advance(milliseconds(2), pull));
  sut.tell(sample(2, {}), set);
  ASSERT_TRUE(set.has_pressure);
  EXPECT_EQ(set.pressure, (Force3{0, 0.25, 0}));
}

TEST(Slave, RestsWhereItIsWhileTheWorldCannotSay) {
  FakeBox box(0.015);
  Slave sut(box, {});
  ASSERT_TRUE(sut.open(sample(1, {})));
  (void)sut.advance(milliseconds(20), pull);
  const Position3 before = sut.at();
  EXPECT_GT(sut.velocity().x, 0.01);
  box.is_silent = true;
  EXPECT_FALSE(sut.advance(milliseconds(20), pull));
  EXPECT_EQ(sut.at(), before);
  EXPECT_EQ(sut.velocity(), Velocity3{});
}

TEST(Slave, StaysCalmBetweenTheHardestControllerAndTheHardestWall) {
  FakeBox box(0.0);
  box.stiffness = kHardestTool.stiffness;
  box.damping = kHardestTool.damping;
  Slave sut(box, {});
  ASSERT_TRUE(sut.open(sample(1, {})));
  const auto hardest = [](Position3 at, Velocity3 velocity, double /*step_s*/) {
    return kHardestController.stiffness * (Position3{0.02, 0, 0} - at) -
           kHardestController.damping * velocity;
  };
  (void)sut.advance(std::chrono::seconds(1), hardest);
  EXPECT_NEAR(sut.at().x, 0.01, 1e-6);
}

TEST(Slave, TellsWhereItIsAndWhatHoldsItsProbe) {
  FakeBox box(0.015);
  Slave sut(box, {});
  ASSERT_TRUE(sut.open(sample(1, {})));
  (void)sut.advance(std::chrono::seconds(1), pull);
  ConstraintSet set;
  sut.tell(sample(9, {}), set);
  EXPECT_EQ(set.answers, 9U);
  EXPECT_TRUE(set.has_far);
  EXPECT_TRUE(set.far.is_pressing);
  EXPECT_EQ(set.far.slave, sut.at());
  ASSERT_EQ(set.planes.size(), 1U);
  EXPECT_EQ(set.ghost.x, 0.015);
}

}  // namespace
}  // namespace thimble::coupling
