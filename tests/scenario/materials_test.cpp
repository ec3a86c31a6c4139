#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble {
namespace {

// The thesis's box as a label volume: its left side is of label 1, its right side of label 2.
class Materials : public ::testing::Test {
 protected:
  Materials() {
    std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 3 3\nencoding: text\n\n";
    for (int i = 0; i < 27; ++i) {
      const int label = i % 3 == 0 ? 1 : i % 3 == 2 ? 2 : 3;
      text += std::to_string(i == 13 ? 0 : label) + "\n";
    }
    path_ = folder_.write("two-materials.nrrd", text).string();
  }

  [[nodiscard]] std::string configuration(const std::string& of_arm) const {
    return R"(
[[arm]]
name = "right"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
world = "two"
[arm.hand]
motion = "explore"
reach_m = 0.022
stiffness_newton_per_m = 600
)" + of_arm +
           R"(
[[world]]
name = "two"
source = ")" +
           path_ + R"("
[[world.material]]
name = "rubber"
from = 1
stiffness_newton_per_m = 120
[[world.material]]
name = "wood"
from = 2
stiffness_newton_per_m = 800
)";
  }

  struct Peaks {
    double from_left_newton{0};
    double from_right_newton{0};
  };
  static Peaks feel(test::ClosedLoop& sut) {
    test::ArmWatch watch(sut);
    Peaks peaks;
    sut.run(40, [&] {
      watch.see();
      peaks.from_left_newton = std::max(peaks.from_left_newton, sut.frame().wish.x);
      peaks.from_right_newton = std::max(peaks.from_right_newton, -sut.frame().wish.x);
    });
    EXPECT_EQ(watch.breach(), "");
    EXPECT_EQ(sut.snapshot().faults, 0U);
    return peaks;
  }

 private:
  testing_support::TemporaryFolder folder_;
  std::string path_;
};

TEST_F(Materials, ASoftWallAndAHardOneFeelDifferent) {
  for (const char* delay : {"0", "0.05"}) {
    test::ClosedLoop sut({std::string("arm.impairment.delay_s=") + delay},
                         {configuration(""), {}, {}});
    const Peaks peaks = feel(sut);
    EXPECT_GT(peaks.from_left_newton, 0.1) << delay;
    EXPECT_GT(peaks.from_right_newton, 1.5 * peaks.from_left_newton) << delay;
  }
}

// How far sideways the force on the finger points, as a share of the largest.
double sideways_share(test::ClosedLoop& sut) {
  double sideways_newton = 0;
  double straight_newton = 0;
  test::ArmWatch watch(sut);
  sut.run(40, [&] {
    watch.see();
    const Force3 force = sut.frame().wish;
    const double x = std::abs(force.x);
    const double y = std::abs(force.y);
    const double z = std::abs(force.z);
    const double largest = std::max({x, y, z});
    straight_newton += largest;
    sideways_newton += x + y + z - largest;
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.snapshot().faults, 0U);
  return sideways_newton / straight_newton;
}

TEST_F(Materials, FrictionHoldsTheFinger) {
  std::string smooth = configuration("");
  smooth.resize(smooth.find("[[world.material]]"));
  const std::string rough =
      smooth + "[[world.material]]\nname = \"all\"\nfrom = 1\nto = 3\nfriction = 0.8\n";
  test::ClosedLoop on_ice({}, {smooth, {}, {}});
  test::ClosedLoop on_rubber({}, {rough, {}, {}});
  EXPECT_GT(sideways_share(on_rubber), sideways_share(on_ice) + 0.1);
}

// Of the same walls without materials: the difference above is not the hand's.
TEST_F(Materials, WithoutThemBothWallsFeelAlike) {
  std::string plain = configuration("");
  plain.resize(plain.find("[[world.material]]"));
  test::ClosedLoop sut({}, {plain, {}, {}});
  const Peaks peaks = feel(sut);
  EXPECT_GT(peaks.from_left_newton, 0.1);
  EXPECT_LT(peaks.from_right_newton, 1.4 * peaks.from_left_newton);
  EXPECT_LT(peaks.from_left_newton, 1.4 * peaks.from_right_newton);
}

}  // namespace
}  // namespace thimble
