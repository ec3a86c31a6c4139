#include "daemon/session/arm_settings.hpp"

#include <gtest/gtest.h>

#include <typeinfo>
#include <vector>

#include "daemon/coupling/passivity_guard.hpp"
#include "daemon/coupling/two_port_arm.hpp"

namespace thimble::session {
namespace {

constexpr double kDepth_m = 0.001;

HapticCapabilities arm_of(double max_stiffness_newton_per_m) {
  HapticCapabilities capabilities;
  capabilities.max_stiffness_newton_per_m = max_stiffness_newton_per_m;
  return capabilities;
}

// What a hand at rest feels that a wall let in by a millimetre before the first force.
double wall_newton(coupling::ArmCoupling& sut, double asked_newton_per_m) {
  using std::chrono::milliseconds;
  coupling::ConstraintSet set;
  set.sequence = set.session = 1;
  set.planes.push_back({{1, 0, 0}, 0.0, {.stiffness = Stiffness{asked_newton_per_m}}});
  MonotonicTime now{milliseconds(1)};
  sut.reset(now, {});
  coupling::ArmInput input{.now = now,
                           .dt = milliseconds(1),
                           .tip = {-kDepth_m, 0, 0},
                           .fresh = &set,
                           .link = {true, milliseconds(1), {}}};
  (void)sut.step(input);
  input.tip = {kDepth_m, 0, 0};
  input.fresh = nullptr;
  input.now = now + milliseconds(1);
  return -sut.step(input).force.x;
}

TEST(MakeCoupling, LetsNoWorldAskForMoreThanTheArmCanRender) {
  const auto soft = make_coupling({}, 0, arm_of(500));
  const auto unknown = make_coupling({}, 0, arm_of(0));
  ASSERT_TRUE(soft && unknown);
  EXPECT_NEAR(wall_newton(**soft, 2000), 500 * kDepth_m, 1e-9);
  EXPECT_NEAR(wall_newton(**soft, 300), 300 * kDepth_m, 1e-9);
  EXPECT_NEAR(wall_newton(**unknown, 2000), 2000 * kDepth_m, 1e-9);
}

TEST(MakeCoupling, BringsItsOwnWallsDownToTheArm) {
  const auto sut = make_coupling({}, 0, arm_of(500));
  ASSERT_TRUE(sut);
  EXPECT_NEAR(wall_newton(**sut, -1), 500 * kDepth_m, 1e-9);
}

TEST(MakeCoupling, LeavesWhatAPersonConfigured) {
  config::ArmConfig arm;
  arm.coupling.stiffness_newton_per_m = 1500;
  const auto sut = make_coupling(arm, 0, arm_of(500));
  ASSERT_TRUE(sut);
  EXPECT_NEAR(wall_newton(**sut, -1), 1500 * kDepth_m, 1e-9);
}

TEST(MakeCoupling, PutsAGuardAroundAnySchemeThatIsToHaveOne) {
  for (const auto scheme :
       {config::CouplingScheme::GhostPoint, config::CouplingScheme::ThesisLiteral,
        config::CouplingScheme::RemoteForce, config::CouplingScheme::SpringDamper,
        config::CouplingScheme::Wave, config::CouplingScheme::ConstraintPlane,
        config::CouplingScheme::BufferZone, config::CouplingScheme::Composite}) {
    config::ArmConfig arm;
    arm.coupling.scheme = scheme;
    const auto bare = make_coupling(arm, 0, arm_of(500));
    arm.coupling.passivity.emplace();
    const auto guarded = make_coupling(arm, 0, arm_of(500));
    ASSERT_TRUE(bare && guarded);
    EXPECT_EQ(dynamic_cast<coupling::PassivityGuard*>(bare->get()), nullptr);
    const auto* guard = dynamic_cast<coupling::PassivityGuard*>(guarded->get());
    ASSERT_NE(guard, nullptr);
    const coupling::ArmCoupling& inside = guard->inside();
    const coupling::ArmCoupling& alone = **bare;
    EXPECT_EQ(typeid(inside), typeid(alone));
  }
}

TEST(MakeCoupling, PutsAMassBetweenTheHandAndTheSpringWhereOneIsSaid) {
  config::ArmConfig arm;
  arm.coupling.scheme = config::CouplingScheme::SpringDamper;
  const auto told_m = [&] {
    const auto sut = make_coupling(arm, 0, arm_of(500)).value();
    sut->reset({}, {});
    const coupling::ArmInput moved{.now = {std::chrono::milliseconds(1)},
                                   .dt = std::chrono::milliseconds(1),
                                   .tip = {0.001, 0, 0}};
    return sut->step(moved).sample.hand.x;
  };
  EXPECT_EQ(told_m(), 0.001) << "the hand is the master";
  arm.coupling.master_mass_kg = 0.1;
  EXPECT_LT(told_m(), 0.0005) << "the mass has yet to follow";
}

config::ArmConfig far_arm() {
  config::ArmConfig arm;
  arm.link = config::UdpEndpoint{"127.0.0.1", 5001};
  arm.protocol = config::LinkProtocol::Thimble;
  return arm;
}

TEST(MakeCoupling, LeavesTheSchemeToAWorldFarAwayWithAnArmHalfThatGoesWithBoth) {
  const config::ArmConfig arm = far_arm();
  ASSERT_TRUE(leaves_scheme_to_world(arm));
  const auto half = make_coupling(arm, 0, arm_of(500));
  ASSERT_TRUE(half);
  EXPECT_NE(dynamic_cast<coupling::CompositeArm*>(half->get()), nullptr);
  const auto asked = arm_end_settings(arm).value();
  EXPECT_EQ(asked.half.scheme.view(), "composite");
  ASSERT_TRUE(asked.else_half);
  EXPECT_EQ(asked.else_half->scheme.view(), "ghost-point");
}

TEST(MakeCoupling, AsksForNothingButWhatASchemeSaysOrAMapDoesNotGoWith) {
  std::vector<config::ArmConfig> arms(6, far_arm());
  arms[0].coupling.scheme = config::CouplingScheme::GhostPoint;
  arms[1].coupling.mode = config::CouplingMode::LockStep;
  arms[2].deadband_m = 0.001;
  arms[3].place_m = {0, 0, 0.1};
  arms[4].protocol = config::LinkProtocol::Thesis;
  arms[5].link.reset();
  for (const config::ArmConfig& arm : arms) {
    EXPECT_FALSE(leaves_scheme_to_world(arm));
    EXPECT_FALSE(arm_end_settings(arm).value().else_half);
    EXPECT_EQ(arm_end_settings(arm).value().half.scheme.view(), "ghost-point");
    const auto half = make_coupling(arm, 0, arm_of(500));
    ASSERT_TRUE(half);
    EXPECT_NE(dynamic_cast<coupling::GhostPointArm*>(half->get()), nullptr);
  }
}

TEST(MakeCoupling, PutsTheArmsEndOfAGuardBetweenBothEndsAroundARemoteForce) {
  config::ArmConfig arm;
  arm.coupling.scheme = config::CouplingScheme::RemoteForce;
  arm.coupling.passivity.emplace().is_two_port = true;
  const auto sut = make_coupling(arm, 0, arm_of(500));
  ASSERT_TRUE(sut);
  EXPECT_NE(dynamic_cast<coupling::TwoPortArm*>(sut->get()), nullptr);
}

}  // namespace
}  // namespace thimble::session
