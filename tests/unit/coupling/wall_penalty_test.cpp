#include "daemon/coupling/wall_penalty.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "arm_bench.hpp"

namespace thimble::coupling {
namespace {

using testing::kMinusX;
using testing::kPlusX;
using testing::kPlusY;
using testing::wall;

constexpr ToolProperties kTool{.stiffness = {800}, .damping = {5}};

PlaneList planes_of(std::initializer_list<ConstraintPlane> all) {
  PlaneList list;
  for (const ConstraintPlane& plane : all) list.push_back(plane);
  return list;
}

TEST(WallPenalty, PushesOutOfAWallAndNotBeforeIt) {
  const PlaneList planes = planes_of({wall(kPlusX, 0.015), wall(kPlusY, 0.020)});
  EXPECT_EQ(wall_penalty(planes, kTool, {0.014, 0.019, 0}, {1, 1, 0}), Force3{});
  const Force3 force = wall_penalty(planes, kTool, {0.017, 0.021, 0}, {});
  EXPECT_NEAR(force.x, -1.6, 1e-12);
  EXPECT_NEAR(force.y, -0.8, 1e-12);
  EXPECT_EQ(force.z, 0);
}

TEST(WallPenalty, DampsAlongTheNormalOnlyAndNeverAttracts) {
  const PlaneList planes = planes_of({wall(kMinusX, 0.015)});
  EXPECT_NEAR(wall_penalty(planes, kTool, {-0.016, 0, 0}, {-0.1, 3, 3}).x, 1.3, 1e-12);
  EXPECT_EQ(wall_penalty(planes, kTool, {-0.016, 0, 0}, {0.5, 0, 0}), Force3{});
}

TEST(WallPenalty, TakesWhatAPlaneNamesUpToTheCeiling) {
  ConstraintPlane soft = wall(kPlusX, 0);
  soft.surface = {.stiffness = {100}, .damping = {0}, .friction = 0.5};
  EXPECT_NEAR(wall_penalty(planes_of({soft}), kTool, {0.01, 0, 0}, {1, 1, 0}).x, -1, 1e-12);
  EXPECT_EQ(wall_penalty(planes_of({soft}), kTool, {0.01, 0, 0}, {1, 1, 0}).y, 0);
  soft.surface.stiffness = {1e9};
  EXPECT_NEAR(wall_penalty(planes_of({soft}), kTool, {0.01, 0, 0}, {}).x, -30, 1e-12);
}

TEST(WallPenalty, UnsoundPlanesDoNotPush) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const ConstraintPlane& plane :
       {wall({2, 0, 0}, 0), wall({kNan, 0, 0}, 0), wall(kPlusX, kNan), wall(kPlusX, -1e7)}) {
    EXPECT_FALSE(is_sound(plane));
    EXPECT_EQ(wall_penalty(planes_of({plane}), kTool, {1, 0, 0}, {}), Force3{});
  }
}

TEST(SoundTool, IsWithinItsCeilingAndFinite) {
  const ToolProperties wild{.stiffness = {1e9}, .damping = {-3}};
  EXPECT_EQ(sound_tool(wild, kHardestTool), (ToolProperties{{3000}, {0}}));
  const ToolProperties mad{.stiffness = {std::numeric_limits<double>::infinity()},
                           .damping = {std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_EQ(sound_tool(mad, kHardestTool), ToolProperties{});
  EXPECT_EQ(sound_tool(kTool, kHardestTool), kTool);
}

}  // namespace
}  // namespace thimble::coupling
