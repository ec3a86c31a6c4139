#include <gtest/gtest.h>

#include "tests/unit/servo/scripted_rig.hpp"

namespace thimble::servo {
namespace {

TEST(ServoLoop, CountsTheEnergyThatItPutsIntoTheHand) {
  ServoRig rig;
  rig.coupling.wish = {2, 0, 0};
  rig.activate_fully();
  const double before = rig.snapshot().frame.generated_energy_j;
  for (int i = 0; i < 1000; ++i) {
    rig.device.state.tip.x += 0.0001;  // 0.1 m/s for 1 s along the force
    rig.tick();
  }
  EXPECT_NEAR(rig.snapshot().frame.generated_energy_j - before, 0.2, 0.002);
}

TEST(ServoLoop, TellsWhatTheWishesWouldHaveGivenBesideWhatWasGiven) {
  ServoRig rig;
  rig.coupling.wish = {50, 0, 0};
  rig.activate_fully();
  const ServoFrame before = rig.snapshot().frame;
  for (int i = 0; i < 100; ++i) {
    rig.device.state.tip.x += 0.0001;
    rig.tick();
  }
  const ServoFrame after = rig.snapshot().frame;
  EXPECT_NEAR(after.wished_energy_j - before.wished_energy_j, 50 * 0.01, 1e-9);
  EXPECT_LT(after.generated_energy_j - before.generated_energy_j, 0.3) << "behind the limiter";
}

}  // namespace
}  // namespace thimble::servo
