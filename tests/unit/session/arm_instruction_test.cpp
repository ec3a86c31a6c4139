#include "daemon/session/arm_instruction.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>
#include <string>

namespace thimble::session {
namespace {

servo::EntryBox box() { return {{}, {0.045, 0.045, 0.03}}; }

TEST(WayInto, IsAlongEachAxisOnWhichTheFingerIsOutside) {
  EXPECT_EQ(way_into(box(), {0, 0.2, 0}), "bring the arm into its world: 155 mm down");
  EXPECT_EQ(way_into(box(), {-0.1, -0.2, 0.0305}),
            "bring the arm into its world: 55 mm right, 155 mm up, 1 mm farther");
  EXPECT_EQ(way_into(box(), {0.1, 0, -0.1}),
            "bring the arm into its world: 55 mm left, 70 mm nearer");
}

TEST(WayInto, IsNothingForOneThatIsInsideOrLeansOnAWall) {
  EXPECT_EQ(way_into(box(), {}), "");
  EXPECT_EQ(way_into(box(), {0.045, -0.045, 0.03}), "");
  EXPECT_EQ(way_into(box(), {0.064, -0.064, 0}), "");
}

TEST(WayInto, IsNothingInAWorldWithoutEndAndForAPositionThatIsNone) {
  EXPECT_EQ(way_into({}, {9, 9, 9}), "");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(way_into(box(), {nan, none, -none}), "");
}

TEST(WayInto, IsAboutTheMiddleOfTheFreePart) {
  const servo::EntryBox placed{{0, 0.2, 0}, {0.045, 0.045, 0.03}};
  EXPECT_EQ(way_into(placed, {0, 0.2, 0}), "");
  EXPECT_EQ(way_into(placed, {0, 0.264, 0}), "");
  EXPECT_EQ(way_into(placed, {0, 0.2661, 0}), "bring the arm into its world: 22 mm down");
}

// Who is told of a way is kept out, and the other way round.
TEST(WayInto, IsToldToWhomTheServoKeepsOut) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> place(-0.1, 0.1);
  for (int i = 0; i < 2000; ++i) {
    const Position3 at{place(random), place(random), place(random)};
    EXPECT_EQ(way_into(box(), at).empty(), box().contains(at))
        << at.x << ' ' << at.y << ' ' << at.z;
  }
}

// Whoever does as it says is inside, and by less than a millimetre more than was needed.
TEST(WayInto, LeadsInside) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-0.3, 0.3);
  int told = 0;
  for (int i = 0; i < 2000; ++i) {
    std::array<double, 3> at{place(random), place(random), place(random)};
    const std::string sut = way_into(box(), {at[0], at[1], at[2]});
    if (sut.empty()) continue;
    ++told;
    std::istringstream words(sut.substr(sut.find(": ") + 2));
    for (std::string piece; std::getline(words, piece, ',');) {
      std::istringstream one(piece);
      double way_mm = 0;
      std::string mm;
      std::string where;
      one >> way_mm >> mm >> where;
      const bool is_back = where == "left" || where == "down" || where == "farther";
      const std::size_t axis = where == "left" || where == "right" ? 0
                               : where == "down" || where == "up"  ? 1
                                                                   : 2;
      at.at(axis) += (is_back ? -1 : 1) * way_mm / 1e3;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_LE(std::abs(at.at(axis)), box().half_m.at(axis) + 2e-9) << sut;
    }
  }
  EXPECT_GT(told, 1000);
}

}  // namespace
}  // namespace thimble::session
