#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "drivers/phantom/find_model.hpp"
#include "drivers/phantom/hid_link.hpp"
#include "drivers/phantom/phantom_device.hpp"
#include "tests/support/made_wrench.hpp"
#include "tests/unit/phantom/scripted_hid.hpp"

namespace thimble::phantom {

inline constexpr std::array<int, 7> kRest{};
inline constexpr std::array<int, 7> kPressed{0, 0, 0, 0, 0, 0, 1};
inline constexpr int kSettleReports = 20;

inline LimitedWrench wrench(double x, double y, double z) {
  return servo::WrenchLimiter::make({x, y, z});
}

class PhantomDeviceTest : public testing::Test {
 protected:
  explicit PhantomDeviceTest(const char* model = "phantom-vintage") : model_(*find_model(model)) {}
  void open(ReportForm form = ReportForm::Mbed, double amplifier_max_a = 3) {
    auto link = std::make_unique<HidLink>(std::make_unique<ScriptedHid>(script_), form);
    sut_ = std::make_unique<PhantomDevice>(std::move(link), model_, amplifier_max_a);
  }
  IoStatus read(const std::array<int, 7>& field, Duration after = std::chrono::milliseconds(1)) {
    script_.arrive(field, after, form_bytes_);
    return sut_->read(state_);
  }
  void press() {
    for (int i = 0; i < Homing::kPressReports; ++i) EXPECT_EQ(read(kPressed), IoStatus::Ok);
  }
  void calibrate() {
    EXPECT_EQ(read(kRest), IoStatus::Ok);
    press();
    for (int i = 0; i <= kSettleReports; ++i) EXPECT_EQ(read(kRest), IoStatus::Ok);
    EXPECT_EQ(state_.calibration, CalibrationState::Ok);
  }
  void expect_no_current() {
    EXPECT_EQ(sut_->write(wrench(1, 2, 3)), IoStatus::Ok);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(script_.sent(wire::kCurrentA + i), 0);
  }
  double current_a(std::size_t motor, Force3 force) const {
    const auto& row = state_.motor_current_per_force.row[motor];
    return row[0] * force.x + row[1] * force.y + row[2] * force.z;
  }

  const PhantomModel& model_;
  std::size_t form_bytes_{14};
  HidScript script_;
  HapticState state_;
  std::unique_ptr<PhantomDevice> sut_;
};

}  // namespace thimble::phantom
