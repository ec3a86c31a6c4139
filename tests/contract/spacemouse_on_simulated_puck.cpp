#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "drivers/spacemouse/pointer.hpp"
#include "drivers/spacemouse/spacemouse_driver.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "sim/model/spacemouse/register_spacemouse_models.hpp"

// Driver and simulated puck were written apart from the same sheet: bytes, signs, frames and units
// must come out the same at both ends. What every arm owes HapticDevice is asked here too.
namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

struct Setting {
  const char* model;
  Duration tick;
};

class SpaceMouseOnSimulatedPuck : public testing::TestWithParam<Setting> {
 protected:
  void SetUp() override {
    plugin::SimModelRegistry models;
    sim::register_spacemouse_models(models);
    auto model = models.find(GetParam().model)->create_hid({});
    ASSERT_TRUE(model);
    ASSERT_TRUE(buses_.plug(address_, std::move(*model)));
    sut_ = open();
    ASSERT_NE(sut_, nullptr);
    puck_ = buses_.arm_backend(address_);
  }
  std::unique_ptr<HapticDevice> open() {
    plugin::DriverSettings settings;
    settings.clock = &clock_;
    auto device = spacemouse::make_spacemouse_driver()->open(buses_, buses_.list().at(0), settings);
    return device ? *std::move(device) : nullptr;
  }
  void run_for(Duration time) {
    for (Duration passed{}; passed < time; passed += GetParam().tick) {
      clock_.run_for(GetParam().tick);
      status_ = sut_->read(state_);
      ASSERT_EQ(sut_->write(LimitedWrench::zero()), status_);
    }
  }
  sim::VirtualClock clock_;
  sim::SimEnumerator buses_{clock_};
  bus::DeviceAddress address_{std::string("sim:") + GetParam().model};
  std::unique_ptr<HapticDevice> sut_;
  plugin::ArmBackend* puck_{nullptr};
  HapticState state_;
  IoStatus status_{};
};

INSTANTIATE_TEST_SUITE_P(Pucks, SpaceMouseOnSimulatedPuck,
                         testing::Values(Setting{"spacemouse", milliseconds(1)},
                                         Setting{"spacemouse", microseconds(125)},
                                         Setting{"spacenavigator", milliseconds(1)},
                                         Setting{"spacenavigator", milliseconds(2)}));

TEST_P(SpaceMouseOnSimulatedPuck, HasNoMotorsAndNeedsNobodyToStopIt) {
  EXPECT_FALSE(sut_->capabilities().is_actuated);
  EXPECT_FALSE(sut_->zero_command());
  run_for(milliseconds(100));
  EXPECT_EQ(state_.motor_current_per_force.row[0], (std::array{0.0, 0.0, 0.0}));
  EXPECT_EQ(sut_->counters().commands_out, 0U);
}

TEST_P(SpaceMouseOnSimulatedPuck, MovesThePointWhereTheCapIsPushedAndStopsWhenItIsLetGo) {
  run_for(milliseconds(100));
  ASSERT_EQ(state_.calibration, CalibrationState::Ok);
  EXPECT_EQ(sut_->calibration_instruction(), "");
  Position3 at = state_.tip;
  for (const Force3 force : {Force3{10, 0, 0}, Force3{0, 10, 0}, Force3{0, 0, 10}}) {
    puck_->push_tip(force);
    run_for(milliseconds(300));
    puck_->push_tip({});
    run_for(milliseconds(200));
    const Displacement3 way = state_.tip - at;
    const Displacement3 wanted = 0.3 * spacemouse::Pointer::kFullSpeed_m_per_s / 10 *
                                 Displacement3{force.x, force.y, force.z};
    EXPECT_LT(norm(way - wanted), 0.006) << "two reports and a spring that gives way";
    at = state_.tip;
    run_for(milliseconds(200));
    EXPECT_EQ(state_.tip, at) << "silent, and still";
  }
  EXPECT_EQ(sut_->counters().malformed, 0U);
}

TEST_P(SpaceMouseOnSimulatedPuck, EveryReadIsASampleOfThatTime) {
  run_for(milliseconds(50));
  const std::uint64_t before = state_.sample_sequence;
  clock_.run_for(milliseconds(1));
  EXPECT_EQ(sut_->read(state_), IoStatus::Ok);
  EXPECT_EQ(state_.sampled_at, clock_.now());
  EXPECT_EQ(state_.sample_sequence, before + 1);
}

TEST_P(SpaceMouseOnSimulatedPuck, WaitsForAPuckThatIsHeldToBeLetGo) {
  puck_->turn_stylus({0, 0.2, 0});
  run_for(milliseconds(300));
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
  EXPECT_NE(sut_->calibration_instruction(), "");
  EXPECT_EQ(state_.tip, Position3{});
  puck_->turn_stylus({});
  run_for(milliseconds(300));
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
}

TEST_P(SpaceMouseOnSimulatedPuck, TellsOfItsButton) {
  puck_->press_stylus_button(true);
  run_for(milliseconds(50));
  EXPECT_EQ(state_.buttons, 1U);
  puck_->press_stylus_button(false);
  run_for(milliseconds(50));
  EXPECT_EQ(state_.buttons, 0U);
}

TEST_P(SpaceMouseOnSimulatedPuck, ForgetsItsPlaceWhenToldTo) {
  run_for(milliseconds(100));
  puck_->push_tip({10, 0, 0});
  run_for(milliseconds(100));
  sut_->forget_calibration();
  run_for(GetParam().tick);
  EXPECT_EQ(state_.calibration, CalibrationState::Unknown) << "seen to be gone";
  puck_->push_tip({});
  run_for(milliseconds(300));
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
  EXPECT_EQ(state_.tip, Position3{});
}

TEST_P(SpaceMouseOnSimulatedPuck, IsGoneWhenUnpluggedAndAnotherOneWhenItReturns) {
  run_for(milliseconds(100));
  ASSERT_TRUE(buses_.unplug(address_));
  run_for(milliseconds(10));
  EXPECT_EQ(status_, IoStatus::Disconnected);
  ASSERT_TRUE(buses_.replug(address_));
  run_for(milliseconds(10));
  EXPECT_EQ(status_, IoStatus::Disconnected) << "latched";
  sut_.reset();
  sut_ = open();
  ASSERT_NE(sut_, nullptr);
  run_for(milliseconds(100));
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
}

}  // namespace
}  // namespace thimble
