#include "daemon/coupling/coordinate_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace thimble::coupling {
namespace {

TEST(CoordinateFrame, ShiftsWithinItsBoundAndCutsTheShiftAtIt) {
  std::mt19937 random(3);
  std::normal_distribution<double> gauss(0, 0.08);
  CoordinateFrame sut(0.25);
  int cut = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Displacement3 before = sut.offset();
    const Displacement3 by{gauss(random), gauss(random), gauss(random)};
    sut.shift(by);
    const Displacement3 moved = sut.offset() - before;
    ASSERT_LE(norm(sut.offset()), 0.25 + 1e-12);
    const double share = dot(moved, by) / dot(by, by);
    ASSERT_NEAR(norm(moved - share * by), 0, 1e-12) << "not along the shift";
    ASSERT_GE(share, 0);
    ASSERT_LE(share, 1 + 1e-12);
    if (share > 1 - 1e-9) continue;
    ++cut;
    ASSERT_NEAR(norm(sut.offset()), 0.25, 1e-9) << "cut before its bound";
  }
  EXPECT_GT(cut, 100);
  sut.reset();
  EXPECT_EQ(sut.offset(), Displacement3{});
}

TEST(CoordinateFrame, AShiftThatIsNotFiniteMovesNothing) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  CoordinateFrame sut(0.25);
  sut.shift({0.01, 0, 0});
  for (const double bad : {kInfinite, -kInfinite, std::nan("")}) {
    sut.shift({bad, 0, 0});
    sut.shift({0, 0.1, bad});
    EXPECT_EQ(sut.offset(), (Displacement3{0.01, 0, 0}));
  }
}

TEST(SymmetricLength, PermutedAxesGiveTheSameBits) {
  std::mt19937 random(4);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 1000; ++i) {
    const Displacement3 v{gauss(random), gauss(random), gauss(random)};
    EXPECT_EQ(symmetric_length_m(v), symmetric_length_m({v.z, -v.x, v.y}));
    EXPECT_EQ(symmetric_length_m(v), symmetric_length_m({-v.y, v.x, v.z}));
    EXPECT_NEAR(symmetric_length_m(v), norm(v), 1e-15 * 8);
  }
}

}  // namespace
}  // namespace thimble::coupling
