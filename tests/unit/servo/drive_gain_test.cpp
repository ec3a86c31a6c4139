#include "daemon/servo/drive_gain.hpp"

#include <gtest/gtest.h>

namespace thimble::servo {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

class DriveGainAtAnyRate : public ::testing::TestWithParam<int> {};

TEST_P(DriveGainAtAnyRate, RisesInHalfASecondAndFallsInTwentyMilliseconds) {
  const Duration dt = microseconds(1'000'000 / GetParam());
  DriveGain sut(milliseconds(500), milliseconds(20));

  int rising = 0;
  while (sut.step(true, dt) < 1) ++rising;
  int falling = 0;
  while (sut.step(false, dt) > 0) ++falling;

  EXPECT_NEAR(rising * seconds(dt), 0.5, 0.003);
  EXPECT_LE(falling * seconds(dt), 0.020);
}

INSTANTIATE_TEST_SUITE_P(Rates, DriveGainAtAnyRate, ::testing::Values(500, 1000, 2000, 8000));

TEST(DriveGain, ACutIsImmediate) {
  DriveGain sut(milliseconds(500), milliseconds(20));
  sut.step(true, milliseconds(400));
  sut.cut();
  EXPECT_EQ(sut.value(), 0);
}

}  // namespace
}  // namespace thimble::servo
