#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

TEST(FeelTheBox, APersonCalibratesActivatesAndFeelsAllSixWalls) {
  test::ClosedLoop sut;
  bool is_felt[3][2] = {};
  double deepest_m = 0;
  sut.run(30, [&] {
    const servo::ServoFrame& frame = sut.frame();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (frame.force[axis] < -0.3) is_felt[axis][1] = true;
      if (frame.force[axis] > 0.3) is_felt[axis][0] = true;
      deepest_m = std::max(deepest_m, std::abs(frame.tip[axis] + frame.offset[axis]) - 0.015);
    }
  });
  const servo::ServoSnapshot& end = sut.snapshot();
  std::printf("state %s contacts %llu peak %.3f N offset %.4f m deepest %.4f m fault %s\n",
              std::string(to_string(end.frame.state)).c_str(),
              static_cast<unsigned long long>(end.total_contacts), end.peak_force_newton,
              end.peak_offset_m, deepest_m, std::string(to_string(end.fault.code)).c_str());
  EXPECT_EQ(end.frame.state, OperatingState::Active);
  EXPECT_EQ(end.fault.code, FaultCode::None);
  EXPECT_GT(end.total_contacts, 5U);
  for (const auto& axis : is_felt) {
    EXPECT_TRUE(axis[0]);
    EXPECT_TRUE(axis[1]);
  }
}

}  // namespace
}  // namespace thimble
