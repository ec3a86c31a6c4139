#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/allocation_count.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/private_copy.hpp"

// The closed loop of the scenarios, with a driver and a simulated arm that were built elsewhere.
namespace thimble {
namespace {

using std::chrono::milliseconds;

class SamplePlugin : public testing::Test {
 protected:
  test::ClosedLoop loop_with(std::vector<std::string> overrides) {
    overrides.push_back("daemon.plugins=['" + plugin_ + "']");
    test::ClosedLoop::Setup setup;
    setup.text = kText;
    return test::ClosedLoop(overrides, setup);
  }
  testing_support::TemporaryFolder folder_;
  std::string plugin_ = testing_support::private_copy(folder_, THIMBLE_SAMPLE_DRIVER);

 private:
  static constexpr const char* kText =
      "[[arm]]\nname = 'right'\ndevice = 'sim:gantry'\nworld = 'box'\n"
      "[arm.hand]\nmotion = 'explore'\nseed = 1\n"
      "[[world]]\nname = 'box'\nsource = 'box:3'\n";
};

TEST_F(SamplePlugin, APersonCalibratesAndFeelsAllSixWalls) {
  test::ClosedLoop sut = loop_with({});
  test::ArmWatch watch(sut);
  bool is_felt[3][2] = {};
  std::string instruction;
  sut.run(30, [&] {
    watch.see();
    if (sut.frame().calibration == CalibrationState::NeedsUser) instruction = sut.instruction();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (sut.frame().force[axis] < -0.3) is_felt[axis][1] = true;
      if (sut.frame().force[axis] > 0.3) is_felt[axis][0] = true;
    }
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_GT(watch.peak_motor_newton(), 0.5);
  EXPECT_EQ(instruction,
            "Hold the tip in the middle of the gantry and press the button on its frame");
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  EXPECT_GT(sut.snapshot().total_contacts, 5U);
  EXPECT_EQ(sut.arm().session().device().capabilities().model, "gantry");
  EXPECT_EQ(sut.arm().session().device().counters().malformed, 0U);
  for (const auto& axis : is_felt) {
    EXPECT_TRUE(axis[0]);
    EXPECT_TRUE(axis[1]);
  }
}

TEST_F(SamplePlugin, TheMotorsPushBackWhereThePersonPushes) {
  test::ClosedLoop sut = loop_with({"arm.hand.motion=still"});
  sut.run_until_leaning();
  EXPECT_LT(sut.frame().force.x, -1);
  EXPECT_NEAR(sut.truth().motor_force.x, sut.frame().force.x, 0.05);
  EXPECT_NEAR(sut.truth().motor_force.y, 0, 0.05);
  EXPECT_NEAR(sut.frame().tip.x, sut.truth().tip.x, 1e-4);
  EXPECT_NEAR(sut.frame().tip.y, sut.truth().tip.y, 1e-4);
  EXPECT_NEAR(sut.frame().tip.z, sut.truth().tip.z, 1e-4);
}

TEST_F(SamplePlugin, EveryAxisPushesAlongItself) {
  test::ClosedLoop sut = loop_with({"arm.hand.motion=still"});
  sut.run_until_driven();
  for (const Force3 push : {Force3{4.5, 0, 0}, Force3{0, -4.5, 0}, Force3{0, 0, 4.5}}) {
    sut.sim_arm().backend().push_tip(push);
    sut.run(0.6);
    EXPECT_GT(norm(sut.truth().motor_force), 1);
    EXPECT_LT(dot(sut.truth().motor_force, push),
              -0.95 * norm(push) * norm(sut.truth().motor_force));
    sut.sim_arm().backend().push_tip({});
    sut.run(0.6);
  }
}

TEST_F(SamplePlugin, AFaultLeavesNoForceAtTheArm) {
  test::ClosedLoop sut = loop_with({"arm.hand.motion=still"});
  sut.run_until_leaning();
  test::ArmWatch watch(sut);
  sut.controls().is_estop_healthy = false;
  sut.run(0.3, [&watch] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.frame().state, OperatingState::Fault);
  EXPECT_EQ(sut.truth().motor_force, Force3{});
  EXPECT_FALSE(sut.truth().is_amplifier_on) << "silence, and the arm's own watchdog";
}

TEST_F(SamplePlugin, AnUnpluggedArmIsCalibratedAgainAndClearedWhenItReturns) {
  test::ClosedLoop sut = loop_with({"arm.hand.motion=still"});
  sut.run_until_leaning();
  sut.unplug();
  sut.run(0.1);
  EXPECT_EQ(sut.frame().state, OperatingState::Lost);
  EXPECT_EQ(sut.truth().motor_force, Force3{});
  sut.sim_arm().backend().push_tip({});
  sut.replug();
  ASSERT_TRUE(
      sut.run_until(2, [&sut] { return sut.frame().calibration == CalibrationState::NeedsUser; }));
  EXPECT_EQ(norm(sut.frame().force), 0);
  ASSERT_TRUE(sut.run_until(2, [&sut] { return sut.frame().state == OperatingState::Fault; }));
  sut.controls().request_clear(sut.snapshot().fault.number);
  sut.run_until_driven();
}

TEST_F(SamplePlugin, SameSeedSameTrace) {
  std::vector<Position3> traces[2];
  for (auto& trace : traces) {
    test::ClosedLoop sut = loop_with({"arm.hand.seed=7"});
    sut.run(5, [&] { trace.push_back(sut.frame().tip); });
  }
  EXPECT_EQ(traces[0], traces[1]);
}

TEST_F(SamplePlugin, TheServoAllocatesNothingThroughIt) {
  test::ClosedLoop sut = loop_with({});
  sut.run_until_driven();
  servo::ServoLoop& loop = sut.arm().session().loop();
  Clock& clock = sut.arm().clock();
  const std::uint64_t before = test::allocation_count();
  for (int tick = 0; tick < 10000; ++tick) {
    (void)clock.sleep_until(clock.now() + milliseconds(1));
    loop.tick({});
  }
  EXPECT_EQ(test::allocation_count() - before, 0U);
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
}

TEST_F(SamplePlugin, RefusesSettingsOfAnotherArm) {
  session::Plugins plugins;
  ASSERT_THAT(plugins.load({plugin_}), testing::IsEmpty());
  const auto model = plugins.models.find("gantry")->create_hid({});
  ASSERT_TRUE(model) << model.error().message;
  bus::BusDeviceInfo info = (*model)->describe();
  EXPECT_EQ(info.address.text, "sim:gantry");
  plugin::DriverSettings settings;
  EXPECT_TRUE(plugins.drivers.match(info, settings));
  settings.model = "crane";
  EXPECT_THAT(plugins.drivers.match(info, settings).error().message,
              testing::HasSubstr("gantry: the model is unknown"));
  settings.model.clear();
  settings.amplifier_max_a = 3;
  EXPECT_THAT(plugins.drivers.match(info, settings).error().message,
              testing::HasSubstr("must not be set"));
  info.product_id = 1;
  EXPECT_EQ(plugins.drivers.match(info, settings).error().code, Errc::NotFound);
}

}  // namespace
}  // namespace thimble
