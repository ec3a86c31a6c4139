#include "hal/plugin/plugin_driver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "daemon/servo/wrench_limiter.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "tests/support/scripted_hid_model.hpp"
#include "tests/unit/plugin/scripted_plugin.hpp"

namespace thimble::plugin {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class PluginDriverTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(buses_.plug(address_, std::make_unique<test::ScriptedHidModel>(wire_)));
    settings_.model = script_.address();
  }
  Result<std::unique_ptr<HapticDevice>> open() {
    return driver_->open(buses_, buses_.list().at(0), settings_);
  }
  void open_or_fail() {
    auto opened = open();
    ASSERT_TRUE(opened) << opened.error().message;
    sut_ = *std::move(opened);
    script_.forces_x.clear();  // it was asked what no force is
  }
  // A frame in which the arm sends a report.
  IoStatus report(std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(14)) {
    wire_->to_send.push_back(std::move(bytes));
    clock_.run_for(milliseconds(1));
    return sut_->read(state_);
  }
  static LimitedWrench newton(double x) {
    servo::LimiterSettings open;
    open.max_force_newton = 5;
    open.max_rise_newton_per_s = 1e9;
    open.peak_current_a = open.continuous_current_a = {3, 3, 3};
    return servo::WrenchLimiter(open).limit({{x, 0, 0}, {}, 1.0, milliseconds(1)}).wrench;
  }

  std::shared_ptr<test::HidModelScript> wire_ = std::make_shared<test::HidModelScript>();
  sim::VirtualClock clock_;
  sim::SimEnumerator buses_{clock_};
  bus::DeviceAddress address_{"sim:scripted"};
  PluginScript script_;
  thimble_driver table_ = scripted_driver();
  std::unique_ptr<Driver> driver_ = make_plugin_driver(table_);
  DriverSettings settings_;
  std::unique_ptr<HapticDevice> sut_;
  HapticState state_;
};

TEST_F(PluginDriverTest, AsksThePluginWhetherADeviceIsItsOwn) {
  bus::BusDeviceInfo info = buses_.list().at(0);
  EXPECT_EQ(driver_->name(), "scripted");
  EXPECT_TRUE(driver_->probe(info, settings_));
  script_.match = THIMBLE_REFUSED;
  script_.reason = "the model\nis unknown";
  EXPECT_EQ(driver_->probe(info, settings_).error().message, "the model?is unknown");
  script_.reason.clear();
  EXPECT_THAT(driver_->probe(info, settings_).error().message, HasSubstr("does not say why"));
  script_.match = 77;
  EXPECT_EQ(driver_->probe(info, settings_).error().code, Errc::InvalidArgument);
  info.vendor_id = 1;
  EXPECT_EQ(driver_->probe(info, settings_).error().code, Errc::NotMine);
}

TEST_F(PluginDriverTest, NeverAsksItAboutWhatItCouldNotDrive) {
  bus::BusDeviceInfo info = buses_.list().at(0);
  info.kind = bus::BusKind::Usb;
  EXPECT_EQ(driver_->probe(info, settings_).error().code, Errc::NotMine);
  for (const std::size_t bad : {0U, 65U}) {
    info = buses_.list().at(0);
    info.output_report_bytes = bad;
    EXPECT_EQ(driver_->probe(info, settings_).error().code, Errc::NotMine) << bad;
  }
}

TEST_F(PluginDriverTest, OpensARealDeviceOnlyWhereTheConfigurationNamesIt) {
  bus::BusDeviceInfo info = buses_.list().at(0);
  info.address.text = "hid:A7";
  EXPECT_EQ(driver_->probe(info, settings_).error().code, Errc::Permission);
  settings_.is_named_by_person = true;
  EXPECT_TRUE(driver_->probe(info, settings_));
}

TEST_F(PluginDriverTest, RefusesWhatThePluginDoesNotOpenOrOpensWrongly) {
  script_.open = THIMBLE_REFUSED;
  script_.reason = "no such luck";
  EXPECT_EQ(open().error().message, "no such luck");
  script_.open = THIMBLE_OK;
  script_.gives_device = false;
  EXPECT_THAT(open().error().message, HasSubstr("gave no device"));
  EXPECT_EQ(script_.closed, 0) << "there was nothing to close";
  script_.gives_device = true;
  script_.capabilities = [](thimble_capabilities& said) { said.peak_force_newton = kNaN; };
  EXPECT_THAT(open().error().message, HasSubstr("claims a force that no arm has"));
  EXPECT_EQ(script_.closed, 1);
  script_.capabilities = [](thimble_capabilities&) {};
  EXPECT_TRUE(open()) << "the bus device was given back each time";
}

// Nothing else would end its force when the plugin takes the daemon with it.
TEST_F(PluginDriverTest, ARealArmMustLetGoByItself) {
  EXPECT_TRUE(open()) << "a simulated one need not";
  bus::BusDeviceInfo real = buses_.list().at(0);
  real.address.text = "hid:A7";
  ASSERT_TRUE(buses_.plug(real.address, std::make_unique<test::ScriptedHidModel>(wire_)));
  settings_.is_named_by_person = true;
  const int closed = script_.closed;
  const auto refused = driver_->open(buses_, real, settings_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::Unsupported);
  EXPECT_THAT(refused.error().message, HasSubstr("the plugin: has an arm without a watchdog"));
  EXPECT_EQ(script_.closed, closed + 1);
  script_.capabilities = [](thimble_capabilities& said) { said.device_watchdog_ns = 50'000'000; };
  EXPECT_TRUE(driver_->open(buses_, real, settings_));
}

TEST_F(PluginDriverTest, HandsEachReportOnWithTheTimeOfItsArrival) {
  open_or_fail();
  EXPECT_EQ(sut_->read(state_), IoStatus::NoData);
  EXPECT_THAT(script_.decoded, IsEmpty());
  EXPECT_EQ(report({1, 2, 3}), IoStatus::Ok);
  ASSERT_THAT(script_.decoded, SizeIs(1));
  EXPECT_EQ(script_.decoded[0].size, 3U);
  EXPECT_EQ(script_.decoded[0].bytes[2], 3);
  EXPECT_EQ(script_.decoded[0].sequence, 1U);
  EXPECT_EQ(script_.decoded[0].arrived_at_ns, clock_.now().since_epoch.count());
  EXPECT_EQ(state_.sampled_at, clock_.now());
  EXPECT_EQ(state_.sample_sequence, 1U);
  EXPECT_EQ(sut_->read(state_), IoStatus::NoData) << "a report is asked about once";
}

TEST_F(PluginDriverTest, ASampleArrivesWithAllItsNumbers) {
  script_.capabilities = [](thimble_capabilities& said) { said.joint_count = 6; };
  open_or_fail();
  script_.sample = [](const thimble_hid_report&, thimble_sample& sample) {
    sample.joint_position_rad[5] = 0.5;
    sample.tip_m[0] = 0.01;
    sample.tip_m[2] = -0.03;
    sample.motor_current_a_per_newton[0][2] = 0.25;
    sample.buttons = 1;
  };
  ASSERT_EQ(report(), IoStatus::Ok);
  EXPECT_EQ(state_.joint_position_rad[5], 0.5);
  EXPECT_EQ(state_.tip, (Position3{0.01, 0, -0.03}));
  EXPECT_EQ(state_.motor_current_per_force.row[0][2], 0.25);
  EXPECT_EQ(state_.motor_current_per_force.row[1][1], 0.4);
  EXPECT_EQ(state_.buttons, 1U);
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
}

TEST_F(PluginDriverTest, AnglesOfNoJointAndOfNoReferenceAreZero) {
  open_or_fail();
  script_.sample = [](const thimble_hid_report& report, thimble_sample& sample) {
    sample.joint_position_rad[1] = sample.joint_position_rad[3] = 0.5;
    if (report.sequence > 1) sample.calibration = THIMBLE_CALIBRATION_NEEDS_PERSON;
  };
  ASSERT_EQ(report(), IoStatus::Ok);
  EXPECT_EQ(state_.joint_position_rad, (std::array{0.0, 0.5, 0.0, 0.0, 0.0, 0.0}));
  ASSERT_EQ(report(), IoStatus::Ok);
  EXPECT_EQ(state_.joint_position_rad, (std::array<double, 6>{}));
}

TEST_F(PluginDriverTest, NothingNewAndNothingSoundLeaveTheStateUntouched) {
  open_or_fail();
  state_.tip = {1, 2, 3};
  script_.decode = THIMBLE_NO_DATA;
  EXPECT_EQ(report(), IoStatus::NoData);
  for (const std::int32_t status : {std::int32_t{THIMBLE_PROTOCOL_ERROR}, -5, 99}) {
    script_.decode = status;
    EXPECT_EQ(report(), IoStatus::ProtocolError);
  }
  EXPECT_EQ(script_.forgotten, 0);
  script_.decode = THIMBLE_OK;
  script_.sample = [](const thimble_hid_report&, thimble_sample& sample) {
    sample.tip_m[1] = kNaN;
  };
  EXPECT_EQ(report(), IoStatus::ProtocolError);
  EXPECT_EQ(script_.forgotten, 1);
  EXPECT_EQ(state_.tip, (Position3{1, 2, 3}));
  EXPECT_EQ(state_.sample_sequence, 0U);
  EXPECT_EQ(sut_->counters().malformed, 4U);
}

TEST_F(PluginDriverTest, NoForceIsAskedForWithoutAReference) {
  open_or_fail();
  EXPECT_EQ(sut_->write(newton(2)), IoStatus::Ok);
  ASSERT_EQ(report(), IoStatus::Ok);
  sut_->write(newton(2));
  sut_->forget_calibration();
  sut_->write(newton(2));
  ASSERT_EQ(report(), IoStatus::Ok);
  script_.sample = [](const thimble_hid_report&, thimble_sample& sample) {
    sample.calibration = THIMBLE_CALIBRATION_NEEDS_PERSON;
  };
  ASSERT_EQ(report(), IoStatus::Ok);
  sut_->write(newton(2));
  EXPECT_THAT(script_.forces_x, ElementsAre(0, 2, 0, 0));
}

// Else the servo would not learn of it, and its limiter would go on from the force of before.
TEST_F(PluginDriverTest, AForgottenReferenceIsBelievedAgainOnlyAfterASampleWithoutOne) {
  open_or_fail();
  std::mt19937 random(11);
  std::string history;  // what the arm was told and said, one letter each
  int taken = 0;
  for (int round = 0; round < 5000; ++round) {
    const char event = "DDDDDDNUFX"[random() % 10];
    history += event;
    if (event == 'F') {
      sut_->forget_calibration();
      continue;
    }
    script_.sample = [event](const thimble_hid_report&, thimble_sample& sample) {
      if (event == 'N') sample.calibration = THIMBLE_CALIBRATION_NEEDS_PERSON;
      if (event == 'U') sample.calibration = THIMBLE_CALIBRATION_UNKNOWN;
      if (event == 'X') sample.tip_m[0] = kNaN;
    };
    if (report() != IoStatus::Ok) continue;
    const std::size_t forgotten = history.find_last_of("FX");
    const bool is_answered = forgotten == std::string::npos ||
                             history.find_first_of("NU", forgotten) != std::string::npos;
    const bool is_reference = event == 'D' && is_answered;
    ASSERT_EQ(state_.calibration == CalibrationState::Ok, is_reference) << round;
    sut_->write(newton(2));
    ASSERT_EQ(script_.forces_x.back(), is_reference ? 2 : 0) << round;
    if (event == 'D' && !is_answered) {
      EXPECT_EQ(sut_->calibration_instruction(), "Press the button");
      EXPECT_EQ(state_.joint_position_rad, (std::array<double, 6>{}));
    }
    if (is_reference) ++taken;
  }
  EXPECT_GT(taken, 500);
}

TEST_F(PluginDriverTest, AReportHasJustTheLengthOfTheDevice) {
  open_or_fail();
  EXPECT_EQ(sut_->write(newton(1)), IoStatus::Ok);
  clock_.run_for(milliseconds(1));
  const std::vector<std::uint8_t> expected{0xAB, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_THAT(wire_->received, ElementsAre(expected));
  script_.encode = THIMBLE_PROTOCOL_ERROR;
  EXPECT_EQ(sut_->write(newton(1)), IoStatus::ProtocolError);
  clock_.run_for(milliseconds(1));
  EXPECT_THAT(wire_->received, SizeIs(1)) << "nothing is sent";
  EXPECT_EQ(sut_->counters().malformed, 1U);
  EXPECT_EQ(sut_->counters().commands_out, 1U);
}

TEST_F(PluginDriverTest, IsAskedAtItsOpeningWhatItsGuardMayWrite) {
  auto opened = open();
  ASSERT_TRUE(opened.has_value());
  EXPECT_THAT(script_.forces_x, ElementsAre(0));
  clock_.run_for(milliseconds(2));
  EXPECT_THAT(wire_->received, IsEmpty()) << "it is kept, not sent";
  sut_ = *std::move(opened);
  ASSERT_TRUE(sut_->zero_command().has_value());
  EXPECT_EQ(sut_->zero_command()->endpoint, 0);
  const std::vector<std::uint8_t> expected{0xAB, 0, 0, 0, 0, 0, 0, 0};
  const auto zero = sut_->zero_command()->bytes;
  EXPECT_EQ(std::vector<std::uint8_t>(zero.begin(), zero.end()), expected);

  sut_.reset();
  script_.encode = THIMBLE_PROTOCOL_ERROR;
  open_or_fail();
  EXPECT_EQ(sut_->zero_command(), std::nullopt);
  EXPECT_EQ(sut_->counters().malformed, 0U) << "nothing was to be sent";
}

TEST_F(PluginDriverTest, SaysWhatAPersonMustDo) {
  open_or_fail();
  EXPECT_THAT(std::string(sut_->calibration_instruction()), HasSubstr("first report"));
  script_.sample = [](const thimble_hid_report&, thimble_sample& sample) {
    sample.calibration = THIMBLE_CALIBRATION_NEEDS_PERSON;
  };
  ASSERT_EQ(report(), IoStatus::Ok);
  EXPECT_EQ(sut_->calibration_instruction(), "Press the button");
  script_.sample = [](const thimble_hid_report&, thimble_sample&) {};
  ASSERT_EQ(report(), IoStatus::Ok);
  EXPECT_EQ(sut_->calibration_instruction(), "");
}

TEST_F(PluginDriverTest, AnUnpluggedArmIsForgottenAndAClosedOneGetsZero) {
  open_or_fail();
  ASSERT_EQ(report(), IoStatus::Ok);
  sut_->write(newton(2));
  ASSERT_TRUE(buses_.unplug(address_));
  EXPECT_EQ(sut_->read(state_), IoStatus::Disconnected);
  EXPECT_EQ(script_.forgotten, 1);
  EXPECT_EQ(sut_->write(newton(2)), IoStatus::Disconnected);
  sut_.reset();
  EXPECT_THAT(script_.forces_x, ElementsAre(2, 0, 0));
  EXPECT_EQ(script_.closed, 1);
}

}  // namespace
}  // namespace thimble::plugin
