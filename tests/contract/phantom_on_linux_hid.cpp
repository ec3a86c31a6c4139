// The driver of the PHANToM family on the machine's own HID bus: the real libudev finds the arm,
// the bus's own threads carry its reports, and behind hidapi's stand-in is the simulated arm.
#include <gtest/gtest.h>
#include <poll.h>

#include <array>
#include <atomic>
#include <memory>

#include "daemon/devices/open_arm.hpp"
#include "drivers/phantom/phantom_driver.hpp"
#include "hal/linux/bus_enumerator.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "tests/support/fake_hidapi.hpp"
#include "tests/support/mock_machine.hpp"
#include "tests/support/open_limiter.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

// The frames of the model's bus, for who stamps in other threads.
class FrameClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override { return {Duration(now_ns_.load())}; }
  Duration sleep_until(MonotonicTime) noexcept override { return {}; }
  void pass(Duration time) noexcept { now_ns_ += time.count(); }

 private:
  std::atomic<Duration::rep> now_ns_{0};
};

class PhantomOnLinuxHid : public testing::Test {
 protected:
  PhantomOnLinuxHid() {
    drivers_.add(phantom::make_phantom_driver());
    plugin::SimModelRegistry models;
    sim::register_arm_models(models);
    model_ = models.find("phantom-vintage")->create_hid({.amplifier_max_a = 6, .seed = 1}).value();
    wire_.attach("/dev/hidraw0");
    machine_.plug(MockMachine::UsbDevice{.serial_number = "ABC1"});
    machine_.plug(MockMachine::HidDevice{.serial_number = "ABC1",
                                         .report_descriptor = plain_report_descriptor(14, 14)});
    settings_.model = "phantom-vintage";
    settings_.amplifier_max_a = 6;
    settings_.is_named_by_person = true;
  }

  Result<std::unique_ptr<HapticDevice>> open() {
    return devices::open_arm(buses_, drivers_, {"hid:ABC1"}, settings_);
  }
  template <class Condition>
  static bool wait_until(const Condition& is_done) {
    for (int i = 0; i < 20'000; ++i) {
      if (is_done()) return true;
      ::poll(nullptr, 0, 1);
    }
    return false;
  }
  // One millisecond of the arm: what it was told, then what it says, seen and answered.
  void run_frame() {
    clock_.pass(milliseconds(1));
    model_->advance(clock_.now());
    const auto received = wire_.received_by_device();
    if (received.size() > seen_) model_->out_report(received.back());
    seen_ = received.size();
    std::array<std::uint8_t, bus::kMaxHidReportBytes> bytes{};
    const std::size_t size = model_->in_report(bytes);
    if (size > 0) {
      wire_.device_sends({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
      ASSERT_TRUE(wait_until([&] { return sut_->read(state_) == IoStatus::Ok; }));
    }
    // Again where the thread that wrote the last one has not come back from it.
    const LimitedWrench wrench = test::wrench_for(force_, *sut_, state_);
    ASSERT_TRUE(wait_until([&] { return sut_->write(wrench) == IoStatus::Ok; }));
    ASSERT_TRUE(wait_until([&] { return wire_.received_by_device().size() > seen_; }));
  }
  void run_for(milliseconds time) {
    for (milliseconds passed{}; passed < time && !HasFatalFailure(); ++passed) run_frame();
  }

  FrameClock clock_;
  MockMachine machine_;
  FakeHidWire wire_;
  linux::BusEnumerator buses_{linux::BusSettings{clock_, {}, {}}};
  plugin::DriverRegistry drivers_;
  plugin::DriverSettings settings_;
  std::unique_ptr<plugin::SimHidModel> model_;
  std::unique_ptr<HapticDevice> sut_;
  HapticState state_;
  Force3 force_{};
  std::size_t seen_{0};
};

TEST_F(PhantomOnLinuxHid, NothingIsOpenedOrSentBeforeAPersonNamesIt) {
  settings_.is_named_by_person = false;
  const auto refused = open();
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, Errc::Permission);
  EXPECT_NE(refused.error().message.find("hid:ABC1"), std::string::npos);
  EXPECT_EQ(FakeHidWire::alive(), 0);
  EXPECT_TRUE(wire_.received_by_device().empty());
}

TEST_F(PhantomOnLinuxHid, OpeningSendsNothingAndClosingNothingButZero) {
  sut_ = open().value();
  EXPECT_EQ(sut_->read(state_), IoStatus::NoData);
  EXPECT_TRUE(wire_.received_by_device().empty());
  sut_.reset();
  for (const FakeHidWire::Report& report : wire_.received_by_device()) {
    EXPECT_EQ(report, FakeHidWire::Report(14, 0));
  }
}

TEST_F(PhantomOnLinuxHid, CalibratesAndPushesAsAskedAndStopsWhenUnplugged) {
  sut_ = open().value();
  plugin::ArmBackend& arm = *model_->arm_backend();
  ASSERT_TRUE(arm.move_tip_to(arm.home_position()));
  clock_.pass(milliseconds(1500));  // the board boots
  run_for(milliseconds(5));
  ASSERT_EQ(state_.calibration, CalibrationState::NeedsUser);
  arm.press_calibration_button(true);
  for (int i = 0; i < 200 && state_.calibration != CalibrationState::Ok; ++i) {
    arm.press_calibration_button(i < 20);
    run_frame();
  }
  ASSERT_EQ(state_.calibration, CalibrationState::Ok);
  force_ = {0.2, 0, 0};
  run_for(milliseconds(20));
  EXPECT_NEAR(arm.truth().motor_force.x, 0.2, 0.05);
  EXPECT_LT(norm(state_.tip - arm.truth().tip), 1e-3);
  force_ = {};
  run_for(milliseconds(20));
  EXPECT_LT(norm(arm.truth().motor_force), 0.02);
  EXPECT_EQ(sut_->counters().malformed, 0U);

  wire_.unplug();
  EXPECT_TRUE(wait_until([&] { return sut_->read(state_) == IoStatus::Disconnected; }));
  EXPECT_EQ(sut_->write(wrench_for({}, *sut_, state_)), IoStatus::Disconnected);
}

}  // namespace
}  // namespace thimble::test
