#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "drivers/falcon/falcon_wire.hpp"
#include "drivers/falcon/firmware_image.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/falcon_image.hpp"
#include "tests/support/temporary_folder.hpp"

// A Falcon in a whole session: another bus, another way to home, the same person, servo and wall.
namespace thimble {
namespace {

const std::vector<std::string> kFalcon{"arm.0.device=sim:falcon-loaded", "arm.hand.motion=still"};

TEST(FalconSession, IsHomedByItsPersonAndPushesBackFromAWall) {
  test::ClosedLoop sut(kFalcon);
  ASSERT_TRUE(sut.run_until(10, [&] { return sut.frame().gain >= 1; }))
      << to_string(sut.frame().state) << ": " << sut.instruction();
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 1e-3) << "driver and arm agree on the pose";

  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  sut.run(0.6);
  EXPECT_TRUE(sut.frame().is_in_contact);
  EXPECT_LT(sut.frame().force.x, -1) << "away from the wall at +x";
  EXPECT_LT(sut.truth().motor_force.x, -0.1)
      << "and so do the motors, weakly: nobody measured them";

  sut.controls().is_estop_healthy = false;
  sut.run(0.01);
  EXPECT_EQ(norm(sut.frame().force), 0);
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Estop);
}

// Somebody set its bridge back to what it has after power-up (or it never took the driver's wish).
TEST(FalconSession, ABridgeThatSendsEach16MsIsStoppedAsOftenAsItIsClearedUntilItIsMended) {
  test::ClosedLoop sut(kFalcon);
  test::ArmWatch watch(sut);
  auto& falcon = dynamic_cast<sim::FalconArmModel&>(sut.sim_arm().backend());
  const auto see = [&] { watch.see(); };
  const auto set_latency_timer = [&](std::uint16_t ms) {
    return falcon.control({.request = falcon::wire::kRequestLatencyTimer, .value = ms}, {});
  };
  const auto is_pushing = [&] {
    watch.see();
    return sut.frame().force.x < -1;
  };
  const auto has_stopped = [&] {
    watch.see();
    return sut.frame().state == OperatingState::Fault;
  };
  ASSERT_TRUE(sut.run_until(10, [&] { return sut.frame().gain >= 1; }));
  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  ASSERT_TRUE(sut.run_until(1, is_pushing));

  ASSERT_EQ(set_latency_timer(16).handshake, plugin::UsbHandshake::Ack);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(sut.run_until(0.2, has_stopped)) << i;
    EXPECT_EQ(sut.snapshot().fault.code, FaultCode::MissedExchanges);
    sut.run(0.05, see);
    EXPECT_EQ(norm(sut.truth().motor_force), 0);
    sut.controls().request_clear(sut.snapshot().fault.number);
    sut.run(0.005, see);
    EXPECT_NE(sut.frame().state, OperatingState::Fault) << i << ": a person may try";
  }
  ASSERT_TRUE(sut.run_until(0.2, has_stopped));
  ASSERT_EQ(set_latency_timer(1).handshake, plugin::UsbHandshake::Ack);
  sut.run(0.05, see);
  sut.controls().request_clear(sut.snapshot().fault.number);
  // From inside the wall: it is not pushed out, but felt when it comes anew.
  sut.sim_arm().backend().push_tip({-4.5, 0, 0});
  sut.run(0.3, see);
  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  EXPECT_TRUE(sut.run_until(2, is_pushing)) << to_string(sut.frame().state);
  EXPECT_EQ(watch.breach(), "");
}

TEST(FalconSession, UploadsTheImageOfItsConfigurationAndPushesAsAskedOnceItIsMeasured) {
  const testing_support::TemporaryFolder folder;
  const std::vector<std::uint8_t> image = test::falcon_image();
  const auto file =
      folder.write("image", {reinterpret_cast<const char*>(image.data()), image.size()});
  test::ClosedLoop sut({"arm.0.device=sim:falcon", "arm.hand.motion=still",
                        "arm.0.firmware=" + file.string(),
                        "arm.0.firmware_sha256=" + falcon::sha256_of(image),
                        "arm.0.newton_per_count=" + std::to_string(10.0 / 4095)});
  test::ArmWatch watch(sut);
  ASSERT_TRUE(sut.run_until(20,
                            [&] {
                              watch.see();
                              return sut.frame().gain >= 1;
                            }))
      << to_string(sut.frame().state) << ": " << sut.instruction();

  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  sut.run(0.6, [&] { watch.see(); });
  EXPECT_TRUE(sut.frame().is_in_contact);
  EXPECT_LT(sut.truth().motor_force.x, -1) << "away from the wall at +x";
  EXPECT_NEAR(norm(sut.frame().force - sut.truth().motor_force), 0, 0.3);

  sut.controls().want_active = false;
  ASSERT_TRUE(sut.run_until(0.5, [&] {
    watch.see();
    return sut.frame().state == OperatingState::Inactive;
  }));
  sut.run(0.02, [&] { watch.see(); });
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
  EXPECT_EQ(watch.breach(), "");
}

TEST(FalconSession, ExploringTheBoxBreaksNoRule) {
  test::ClosedLoop sut({"arm.0.device=sim:falcon-loaded"});
  test::ArmWatch watch(sut);
  sut.run(15, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  EXPECT_GT(sut.snapshot().total_contacts, 0U);
}

TEST(FalconSession, WithoutFirmwareItStaysConfiguredAndSaysWhatItNeeds) {
  test::ClosedLoop sut({"arm.0.device=sim:falcon"});
  sut.run(5);
  EXPECT_NE(sut.frame().state, OperatingState::Active);
  EXPECT_NE(sut.instruction(), "");
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
}

// A cable that lets a device have the beginning of a packet only: TruncateOut of FaultyUsb.
sim::FaultPlan packets_out_cut(Duration from, Duration lasts, std::uint64_t reports) {
  sim::FaultPlan plan;
  plan.seed = 7;
  sim::ScriptedFault cut;
  cut.kind = sim::FaultKind::TruncateOut;
  cut.from = MonotonicTime{from};
  cut.lasts = lasts;
  cut.reports = reports;
  cut.endpoint = falcon::wire::kBulkOut;
  plan.script.push_back(cut);
  return plan;
}

// Until 8 s have passed, when the cable begins to cut: active, and pushed against a wall.
void push_until_the_cut(test::ClosedLoop& sut, test::ArmWatch& watch) {
  ASSERT_TRUE(sut.run_until(7.5, [&] {
    watch.see();
    return sut.frame().gain >= 1;
  }));
  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  const MonotonicTime cut{std::chrono::seconds(8)};
  while (sut.now() < cut) sut.run(0.01, [&] { watch.see(); });
  ASSERT_TRUE(sut.frame().is_in_contact);
}

// A command of which the arm takes the beginning is none to it, and the next one is whole.
TEST(FalconSession, APacketThatIsCutWhileItPushesCostsNoMoreThanItself) {
  test::ClosedLoop::Setup setup;
  setup.cables = packets_out_cut(std::chrono::seconds(8), std::chrono::milliseconds(6),
                                 std::numeric_limits<std::uint64_t>::max());
  test::ClosedLoop sut(kFalcon, setup);
  test::ArmWatch watch(sut);
  ASSERT_NO_FATAL_FAILURE(push_until_the_cut(sut, watch));
  sut.run(1, [&] { watch.see(); });
  EXPECT_GT(sut.injected().of(sim::FaultKind::TruncateOut), 0U);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_LT(sut.truth().motor_force.x, -0.1) << "it pushes on";
  EXPECT_EQ(watch.breach(), "");
}

// Cut for longer it is an arm that does not answer: latched, told, and without force as soon as its
// cable lets a zero pass.
TEST(FalconSession, PacketsThatAreCutForLongStopItVisibly) {
  test::ClosedLoop::Setup setup;
  setup.cables = packets_out_cut(std::chrono::seconds(8), std::chrono::milliseconds(500),
                                 std::numeric_limits<std::uint64_t>::max());
  test::ClosedLoop sut(kFalcon, setup);
  test::ArmWatch watch(sut);
  ASSERT_NO_FATAL_FAILURE(push_until_the_cut(sut, watch));
  sut.run(1, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Fault);
  EXPECT_EQ(norm(sut.frame().force), 0);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::StaleSample);
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(norm(sut.truth().motor_force), 0) << "the cable let a zero pass";
}

// The echo of a chunk that came cut does not fit: the upload is begun anew, and in the end the arm
// runs.
TEST(FalconSession, APacketThatIsCutInTheUploadCostsTheUploadAndNotTheArm) {
  const testing_support::TemporaryFolder folder;
  const std::vector<std::uint8_t> image = test::falcon_image();
  const auto file =
      folder.write("image", {reinterpret_cast<const char*>(image.data()), image.size()});
  test::ClosedLoop::Setup setup;
  setup.cables = packets_out_cut({}, Duration::max(), 3);
  setup.cables.script[0].first_report = 60;
  test::ClosedLoop sut(
      {"arm.0.device=sim:falcon", "arm.hand.motion=still", "arm.0.firmware=" + file.string(),
       "arm.0.firmware_sha256=" + falcon::sha256_of(image)},
      setup);
  bool is_told = false;
  ASSERT_TRUE(sut.run_until(40, [&] {
    is_told = is_told || sut.instruction().find("is tried again") != std::string::npos;
    return sut.frame().gain >= 1;
  })) << sut.instruction();
  EXPECT_EQ(sut.injected().of(sim::FaultKind::TruncateOut), 3U);
  EXPECT_TRUE(is_told);
}

}  // namespace
}  // namespace thimble
