#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "daemon/app/arm_commands.hpp"
#include "tests/support/closed_loop.hpp"

// What a client is told that activates an arm outside of its world.
namespace thimble {
namespace {

using testing::HasSubstr;

constexpr api::ClientId kHer{7};

TEST(CommandsOutsideTheWorld, AnActivationIsAnsweredWithTheWayInAndComesTrueInside) {
  test::ClosedLoop loop{{"arm.hand.motion=still", "arm.activate=false", "world.0.workspace_m=0.09",
                         "arm.0.place_m=[0, 0.05, 0]", "arm.0.coupling.scheme=ghost-point"}};
  app::Leases leases{{{"right", false}}};
  app::ArmCommands sut{loop.runtime(), leases, loop.arm().clock()};
  const auto state = [&] { return loop.frame().state; };
  ASSERT_TRUE(loop.run_until(2, [&] { return state() == OperatingState::Inactive; }));
  loop.run(1);
  std::optional<Result<api::Done>> told;
  sut.activate("right", kHer, [&](const Result<api::Done>& done) { told = done; });
  loop.run_until(2.1, [&] {
    sut.poll();
    return told.has_value();
  });
  ASSERT_TRUE(told && *told);
  EXPECT_EQ((*told)->state, "inactive");
  EXPECT_THAT((*told)->instruction, HasSubstr("bring the arm into its world: "));
  EXPECT_THAT((*told)->instruction, HasSubstr(" mm down"));
  EXPECT_EQ(leases.holder(0), app::Leases::Holder::Client);

  loop.run(1, [&] { ASSERT_EQ(norm(loop.truth().motor_force), 0); });
  loop.sim_arm().backend().hold_tip(nullptr);
  loop.sim_arm().backend().push_tip({0, -0.3, 0});
  EXPECT_TRUE(loop.run_until(2, [&] { return state() == OperatingState::Active; }))
      << loop.frame().tip.y;

  // Without the deadman it is carried out again.
  loop.controls().is_deadman_held = false;
  loop.sim_arm().backend().push_tip({0, 0.3, 0});
  ASSERT_TRUE(loop.run_until(2, [&] { return loop.frame().tip.y > 0; }));
  loop.controls().is_deadman_held = true;
  loop.run(0.05);
  sut.steady_force("right", 0.5, kHer, [&](const Result<api::Done>& done) { told = done; });
  ASSERT_FALSE(*told);
  EXPECT_THAT((*told).error().message,
              HasSubstr("arm 'right' has no force where it is: bring the"));
  EXPECT_EQ(norm(loop.frame().force), 0);
}

}  // namespace
}  // namespace thimble
