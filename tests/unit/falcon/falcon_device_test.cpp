#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <type_traits>

#include "tests/unit/falcon/falcon_device_fixture.hpp"
#include "tests/unit/falcon/scripted_loader.hpp"

namespace thimble::falcon {
namespace {

// No way around the limiter: the one for the plugin is private.
template <class Arm>
concept TakesABareForce = requires(Arm& arm, Force3 force) {
  arm.write(force);
}
|| requires(Arm& arm, Force3 force) { arm.drive(force); };
static_assert(!TakesABareForce<FalconDevice>);
static_assert(!std::is_constructible_v<LimitedWrench, Force3>);

TEST_F(FalconDeviceTest, SaysWhatTheTableSays) {
  const HapticCapabilities& capabilities = sut_->capabilities();
  EXPECT_EQ(capabilities.model, "falcon");
  EXPECT_EQ(capabilities.joint_count, 3U);
  EXPECT_EQ(capabilities.peak_force_newton, model_.peak_force_newton);
  EXPECT_EQ(capabilities.peak_current_a, (std::array{1.0, 1.0, 1.0}));
  EXPECT_EQ(capabilities.continuous_current_a[2], model_.continuous_share);
  EXPECT_EQ(capabilities.device_watchdog, Duration::zero()) << "none is known";
  EXPECT_EQ(capabilities.full_rate_hz, 4000);
}

TEST_F(FalconDeviceTest, SaysWhatANewtonAsksOfEachMotorAtMostInTheWorkspace) {
  const FalconKinematics kinematics(model_, model_.newton_per_count);
  const std::array<double, 3>& most = sut_->capabilities().most_current_a_per_newton;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> within(-model_.workspace_radius_m,
                                                model_.workspace_radius_m);
  std::array<double, 3> largest{};
  for (int i = 0; i < 20000; ++i) {
    const Position3 tip{within(random), within(random), within(random)};
    if (norm(tip.x, tip.y, tip.z) > model_.workspace_radius_m) continue;
    ArmPose pose;
    ASSERT_EQ(kinematics.inverse(tip, pose.crank_rad), PoseTrouble::None);
    ASSERT_EQ(kinematics.forward(pose.crank_rad, tip, pose), PoseTrouble::None);
    for (std::size_t motor = 0; motor < 3; ++motor) {
      const auto& row = pose.command_per_force.row[motor];
      const double share = norm(row[0], row[1], row[2]) / wire::kMaxMotor_counts;
      ASSERT_LE(share, most[motor]);
      largest[motor] = std::max(largest[motor], share);
    }
  }
  for (std::size_t motor = 0; motor < 3; ++motor) EXPECT_GT(largest[motor], 0.96 * most[motor]);
}

TEST_F(FalconDeviceTest, HasSentNothingBeforeTheFirstWrite) {
  EXPECT_EQ(read(), IoStatus::NoData);
  EXPECT_TRUE(script_.requests.empty());
  EXPECT_TRUE(script_.submitted.empty());
}

TEST_F(FalconDeviceTest, FindsAFirmwareThatRuns) {
  boot();
  EXPECT_EQ(script_.requests.size(), 4U) << "the settings of run mode";
  write();
  ASSERT_EQ(packets(), 1U);
  EXPECT_EQ(reply({1, 2, 3}), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
}

TEST_F(FalconDeviceTest, UploadsItsImageBetweenTicksAndMovesNothingMeanwhile) {
  test::Bytes image(500);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<std::uint8_t>(i);
  open(image);
  test::ScriptedLoader arm({}, image.size());
  bool is_running = false;
  for (int ms = 0; ms < 3000 && !is_running; ++ms) {
    const std::size_t requests = script_.requests.size();
    const std::size_t packets = script_.submitted.size();
    ASSERT_EQ(write(5, 5, 5), IoStatus::Backlogged) << "no force is taken";
    ASSERT_LE(script_.requests.size() + script_.submitted.size(), requests + packets + 1)
        << "one order in a tick";
    if (script_.requests.size() > requests) arm.on_request(script_.requests.back());
    if (script_.submitted.size() > packets) arm.on_packet(script_.submitted.back());
    script_.arrive(arm.take_output(62));
    ASSERT_EQ(read(), IoStatus::NoData);
    is_running = sut_->calibration_instruction().starts_with("Pull");
  }
  ASSERT_TRUE(is_running);
  EXPECT_EQ(arm.image, image);
  EXPECT_EQ(state_.calibration, CalibrationState::Unknown);
}

TEST_F(FalconDeviceTest, TellsAPersonWhatIsMissing) {
  EXPECT_TRUE(sut_->calibration_instruction().starts_with("Wait for the first packet"));
  pass();
  EXPECT_TRUE(sut_->calibration_instruction().starts_with("Wait while"));
  for (int ms = 0; ms < 600; ++ms) {
    write();
    pass();
  }
  EXPECT_TRUE(sut_->calibration_instruction().starts_with("The Falcon has no firmware"));
  EXPECT_EQ(packets(), 11U) << "no question to the boot-loader, nothing uploaded";
  open();
  home();
  EXPECT_EQ(sut_->calibration_instruction(), "");
}

TEST_F(FalconDeviceTest, AsksForHomingAndHasNoForceUntilAllThreeAreHomed) {
  boot();
  for (int flags : {0x00, 0x10, 0x30, 0x60}) {
    for (int i = 0; i < 20; ++i) {
      EXPECT_EQ(write(8, 8, 8), IoStatus::Ok);
      EXPECT_EQ(sent(), (Counts{0, 0, 0}));
      EXPECT_EQ(sent_flags() & wire::kHomingOn, wire::kHomingOn);
      EXPECT_EQ(reply(kSomewhere, flags), IoStatus::Ok);
      EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser) << flags;
      EXPECT_EQ(state_.tip, Position3{}) << "a made-up place is the middle";
    }
  }
}

TEST_F(FalconDeviceTest, OnceHomedItStopsAskingAndPushes) {
  home();
  EXPECT_EQ(write(0, 0, -5), IoStatus::Ok);
  EXPECT_EQ(sent_flags() & wire::kHomingOn, 0);
  for (const std::int16_t counts : sent()) EXPECT_GT(counts, 0) << "into the device";
}

TEST_F(FalconDeviceTest, LightsSayWhatItIsDoing) {
  boot();
  write();
  EXPECT_EQ(sent_flags() & 0x0e, wire::kLedRed);
  home();
  write();
  EXPECT_EQ(sent_flags(), wire::kLedGreen);
  reply(kSomewhere);
  write(1, 0, 0);
  EXPECT_EQ(sent_flags(), wire::kLedGreen | wire::kLedBlue);
}

TEST_F(FalconDeviceTest, StateCarriesPoseButtonsAndTheMapOfForces) {
  home();
  const std::uint64_t before = state_.sample_sequence;
  write();
  ASSERT_EQ(
      reply({500, 500, 500}, kHomed | wire::kButtonCentre | wire::kButtonRight, milliseconds(3)),
      IoStatus::Ok);
  EXPECT_EQ(state_.sampled_at, script_.now);
  EXPECT_EQ(state_.sample_sequence, before + 1);
  EXPECT_EQ(state_.buttons, 0b1001U) << "the middle one is the stylus button";
  EXPECT_NEAR(state_.joint_position_rad[1], model_.home_angle_rad + 500 * 0.03643 * 3.14159 / 180,
              1e-4);
  EXPECT_NEAR(state_.tip.x, 0, 1e-6);
  EXPECT_GT(state_.tip.z, 0.02);
  // 4 N towards the person, by the map and on the wire.
  write(0, 0, 4);
  for (std::size_t motor = 0; motor < 3; ++motor) {
    const double share = state_.motor_current_per_force.row[motor][2] * 4;
    EXPECT_NEAR(sent()[motor], share * wire::kMaxMotor_counts, 1);
  }
}

TEST_F(FalconDeviceTest, CommandsBeyondTheLargestAreScaledTogether) {
  home();
  write(0, 0, -1000);
  const Counts most = sent();
  EXPECT_EQ(*std::max_element(most.begin(), most.end()), wire::kMaxMotor_counts);
  reply(kSomewhere);
  write(0, 0, -10);
  const Counts some = sent();
  const double scale = static_cast<double>(most[0]) / some[0];
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(most[i] / scale, some[i], 2);
}

TEST_F(FalconDeviceTest, AForceThatIsNoNumberIsNone) {
  home();
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e308}) {
    write(bad, 0, bad);
    EXPECT_EQ(sent(), (Counts{0, 0, 0}));
    reply(kSomewhere);
  }
}

TEST_F(FalconDeviceTest, OneRequestIsUnderWayAtATime) {
  home();
  EXPECT_EQ(write(1, 0, 0), IoStatus::Ok);
  EXPECT_EQ(write(2, 0, 0), IoStatus::Backlogged);
  pass();
  EXPECT_EQ(write(3, 0, 0), IoStatus::Backlogged);
  EXPECT_EQ(packets(), 1U);
  EXPECT_EQ(reply(kSomewhere), IoStatus::Ok);
  EXPECT_EQ(write(4, 0, 0), IoStatus::Ok);
  EXPECT_EQ(packets(), 2U);
}

TEST_F(FalconDeviceTest, AReplyThatIsLostIsNotWaitedForLongerThanItsTime) {
  home();
  write(1, 0, 0);
  for (Duration waited{}; waited + milliseconds(1) < ExchangePacer::kPatience;
       waited += milliseconds(1)) {
    EXPECT_EQ(pass(), IoStatus::NoData);
    EXPECT_EQ(write(1, 0, 0), IoStatus::Backlogged);
  }
  pass();
  EXPECT_EQ(write(1, 0, 0), IoStatus::Ok);
  EXPECT_EQ(packets(), 2U);
}

TEST_F(FalconDeviceTest, ALateReplyDoesNotLeaveTwoRequestsUnderWay) {
  home();
  write(1, 0, 0);
  pass(ExchangePacer::kPatience);
  EXPECT_EQ(write(1, 0, 0), IoStatus::Ok);
  reply(kSomewhere);  // to the first
  EXPECT_EQ(write(1, 0, 0), IoStatus::Backlogged) << "the second may still be answered";
  reply(kSomewhere);
  EXPECT_EQ(write(1, 0, 0), IoStatus::Ok);
  EXPECT_EQ(write(1, 0, 0), IoStatus::Backlogged) << "in step again";
  EXPECT_EQ(packets(), 3U);
}

TEST_F(FalconDeviceTest, TakingTheForceAwayWaitsForNothing) {
  home();
  write(0, 0, -5);
  EXPECT_EQ(write(0, 0, -5), IoStatus::Backlogged);
  EXPECT_EQ(write(0, 0, 0), IoStatus::Ok);
  EXPECT_EQ(sent(), (Counts{0, 0, 0}));
  EXPECT_EQ(write(0, 0, 0), IoStatus::Backlogged) << "once is enough";
}

TEST_F(FalconDeviceTest, AnEncoderThatJumpsLosesTheReference) {
  home();
  write(1, 0, 0);
  EXPECT_EQ(reply({3000, -200, 300}, kHomed), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
  EXPECT_EQ(sut_->counters().malformed, 1U);
  write(1, 0, 0);
  EXPECT_EQ(sent(), (Counts{0, 0, 0}));
  EXPECT_EQ(sent_flags() & wire::kHomingOn, wire::kHomingOn);
}

// However many good reports come in the same tick behind the bad one.
TEST_F(FalconDeviceTest, ALossIsToldThoughTheReferenceCameBackAtOnce) {
  home();
  write(1, 0, 0);
  for (int i = 0; i < 20; ++i) script_.arrive(test::report_bytes({3000, 3000, 3000}, kHomed));
  EXPECT_EQ(read(), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
}

TEST_F(FalconDeviceTest, EncodersThatNoPoseFitsAreNoReference) {
  home({0, 0, 0});
  // As fast as a motor can, to where a crank would be far beyond its stop.
  for (std::int16_t counts = 0; counts < 4000; counts = static_cast<std::int16_t>(counts + 100)) {
    write(0, 0, 1);
    ASSERT_EQ(reply({counts, 0, 0}), IoStatus::Ok);
    if (state_.calibration != CalibrationState::Ok) {
      EXPECT_GT(counts, 1000);
      return;
    }
    ASSERT_TRUE(is_finite(state_.tip));
  }
  ADD_FAILURE() << "it took every angle for a pose";
}

TEST_F(FalconDeviceTest, BrokenBytesAreCountedAndCostTheirReportOnly) {
  home();
  write();
  test::Bytes broken = test::report_bytes(kSomewhere, 0);
  broken.resize(9);
  script_.arrive(broken);
  EXPECT_EQ(read(), IoStatus::NoData) << "it may go on";
  script_.arrive(test::report_bytes(kSomewhere, 0));
  EXPECT_EQ(read(), IoStatus::Ok);
  script_.arrive({'x', 'y'});
  EXPECT_EQ(read(), IoStatus::ProtocolError);
  EXPECT_EQ(sut_->counters().malformed, 2U);
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
}

TEST_F(FalconDeviceTest, OfGluedRepliesTheNewestCountsAndTheOthersAreCounted) {
  home();
  const std::uint64_t before = sut_->counters().reports_in;
  test::Bytes glued = test::report_bytes({110, -200, 300}, 0);
  const test::Bytes newest = test::report_bytes({120, -200, 300}, 0);
  glued.insert(glued.end(), newest.begin(), newest.end());
  script_.arrive(glued);
  EXPECT_EQ(read(), IoStatus::Ok);
  EXPECT_EQ(sut_->counters().reports_in, before + 2);
  EXPECT_EQ(sut_->counters().reports_skipped, 1U);
  const double expected_rad = FalconKinematics(model_, 1).crank_angles({120, 0, 0})[0];
  EXPECT_EQ(state_.joint_position_rad[0], expected_rad);
}

TEST_F(FalconDeviceTest, UnpluggingLatchesAndForgets) {
  home();
  script_.is_connected = false;
  EXPECT_EQ(read(), IoStatus::Disconnected);
  EXPECT_EQ(write(1, 0, 0), IoStatus::Disconnected);
  EXPECT_FALSE(sut_->calibration_instruction().empty());
}

TEST_F(FalconDeviceTest, ForgettingAsksTheArmAgain) {
  home();
  sut_->forget_calibration();
  write(1, 0, 0);
  EXPECT_EQ(sent(), (Counts{0, 0, 0}));
  EXPECT_EQ(reply(kSomewhere, 0), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
}

TEST_F(FalconDeviceTest, LeavesZeroAndDarknessBehind) {
  home();
  write(0, 0, -5);
  sut_.reset();
  EXPECT_EQ(packets(), 2U);
  EXPECT_EQ(sent(), (Counts{0, 0, 0}));
  EXPECT_EQ(sent_flags(), 0);
}

TEST_F(FalconDeviceTest, TellsItsGuardThePacketOfZeroAndDarkness) {
  home();
  const auto zero = sut_->zero_command();
  ASSERT_TRUE(zero.has_value());
  EXPECT_EQ(zero->endpoint, 0x02);
  write(0, 0, -5);
  sut_.reset();
  EXPECT_EQ(std::vector<std::uint8_t>(zero->bytes.begin(), zero->bytes.end()),
            script_.submitted.back());
}

TEST_F(FalconDeviceTest, AnArmThatNeverRanIsLeftInSilence) {
  pass();
  write();
  script_.submitted.clear();
  sut_.reset();
  EXPECT_TRUE(script_.submitted.empty());
}

// Whatever arrives: no force that was not asked for, none before the arm is homed, never more than
// the largest command, and every number finite.
TEST_F(FalconDeviceTest, AnyBytesGiveNoForceThatWasNotAskedFor) {
  std::mt19937 random(21);
  for (int round = 0; round < 40; ++round) {
    open();
    home();
    bool was_homed = true;
    for (int tick = 0; tick < 300; ++tick) {
      test::Bytes bytes;
      const int kind = test::between(random, 0, 9);
      if (kind < 4) bytes = test::report_bytes(kSomewhere, kHomed);
      if (kind == 4) bytes = test::any_report(random);
      if (kind == 5) bytes.assign(static_cast<std::size_t>(test::between(random, 0, 62)), '<');
      script_.arrive(bytes, milliseconds(test::between(random, 0, 6)));
      if (read() == IoStatus::Ok) was_homed = state_.calibration == CalibrationState::Ok;
      ASSERT_TRUE(is_finite(state_.tip));
      script_.submitted.clear();
      write(0, 0, -3);
      if (script_.submitted.empty()) continue;
      if (script_.submitted.back().size() != 16) continue;
      for (const std::int16_t counts : sent()) {
        ASSERT_LE(std::abs(counts), wire::kMaxMotor_counts);
        if (!was_homed && sut_->calibration_instruction() != "") {
          ASSERT_EQ(counts, 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace thimble::falcon
