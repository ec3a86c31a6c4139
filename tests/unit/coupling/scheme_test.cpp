#include "daemon/coupling/scheme.hpp"

#include <gtest/gtest.h>

#include "daemon/coupling/thesis_literal.hpp"
#include "daemon/world/voxel_world.hpp"

namespace thimble::coupling {
namespace {

TEST(Scheme, NamesAreReadAsTheyAreWritten) {
  for (const Scheme scheme : kSchemes) {
    const Result<Scheme> parsed = parse_scheme(to_string(scheme));
    ASSERT_TRUE(parsed);
    EXPECT_EQ(*parsed, scheme);
  }
}

TEST(Scheme, UnknownNameIsRefusedWithWhatWasExpected) {
  for (const char* text : {"", "ghost", "Ghost-Point", "ghost-point "}) {
    const Result<Scheme> parsed = parse_scheme(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().code, Errc::InvalidArgument);
    EXPECT_NE(parsed.error().message.find("ghost-point, thesis-literal, remote-force, "
                                          "spring-damper, wave, constraint-plane, buffer-zone or "
                                          "composite"),
              std::string::npos);
  }
}

TEST(Scheme, MakesTheArmHalfItNames) {
  const auto ghost = make_arm_coupling(Scheme::GhostPoint, {});
  const auto literal = make_arm_coupling(Scheme::ThesisLiteral, {});
  EXPECT_NE(dynamic_cast<GhostPointArm*>(ghost.get()), nullptr);
  EXPECT_NE(dynamic_cast<ThesisLiteralArm*>(literal.get()), nullptr);
  const auto remote = make_arm_coupling(Scheme::RemoteForce, {});
  const auto spring = make_arm_coupling(Scheme::SpringDamper, {});
  const auto wave = make_arm_coupling(Scheme::Wave, {});
  EXPECT_NE(dynamic_cast<RemoteForceArm*>(remote.get()), nullptr);
  EXPECT_NE(dynamic_cast<SpringDamperArm*>(spring.get()), nullptr);
  EXPECT_NE(dynamic_cast<WaveArm*>(wave.get()), nullptr);
  const auto plane = make_arm_coupling(Scheme::ConstraintPlane, {});
  EXPECT_NE(dynamic_cast<ConstraintPlaneArm*>(plane.get()), nullptr);
  const auto zone = make_arm_coupling(Scheme::BufferZone, {});
  EXPECT_NE(dynamic_cast<BufferZoneArm*>(zone.get()), nullptr);
  const auto composite = make_arm_coupling(Scheme::Composite, {});
  EXPECT_NE(dynamic_cast<CompositeArm*>(composite.get()), nullptr);
}

TEST(Scheme, MakesTheWorldHalfOfWhatHasItsOwn) {
  world::VoxelWorld box(world::make_box(3).value(), "box:3");
  for (const Scheme scheme : kSchemes) {
    const auto made = make_own_world_half(scheme, {}, box, 3);
    EXPECT_EQ(made.has_value(), has_own_world_half(scheme)) << to_string(scheme);
    if (!made) continue;
    HandSample first;
    first.sequence = 1;
    ASSERT_TRUE((*made)->open(first));
    const ConstraintSet set = (*made)->answer(first, std::chrono::milliseconds(1));
    EXPECT_EQ(set.has_near, scheme == Scheme::BufferZone) << to_string(scheme);
    EXPECT_EQ(set.has_map, scheme == Scheme::Composite) << to_string(scheme);
    EXPECT_EQ(set.has_far, !set.has_near && !set.has_map) << to_string(scheme);
    EXPECT_EQ(set.session, 3U);
    EXPECT_EQ(set.answers, 1U);
  }
}

}  // namespace
}  // namespace thimble::coupling
