#pragma once

#include <gtest/gtest.h>

#include <cstddef>

#include "tests/unit/servo/scripted_rig.hpp"

namespace thimble::servo {

// The plug of an arm that may push is pulled, and put back.
struct ServoReturn : testing::Test {
  void lose() {
    rig.device.next_status = IoStatus::Disconnected;
    rig.tick(5);
  }
  // As its driver finds it: it knows nothing.
  void put_back() {
    rig.device.next_status = IoStatus::Ok;
    rig.device.state.calibration = CalibrationState::NeedsUser;
    rig.device.written.clear();
    rig.tick(5);
  }
  void calibrate() {
    rig.device.state.calibration = CalibrationState::Ok;
    rig.tick(2);
  }
  ClearOutcome clear() {
    rig.controls.request_clear(rig.snapshot().fault.number);
    rig.tick();
    return rig.snapshot().clear_outcome;
  }
  void expect_it_is_cleared_last() {
    expect_nothing_pushed();
    calibrate();
    EXPECT_EQ(rig.state(), OperatingState::Fault);
    rig.tick(1000);
    EXPECT_EQ(rig.state(), OperatingState::Fault);
    expect_nothing_pushed();
    EXPECT_EQ(clear(), ClearOutcome::Cleared);
    rig.tick(1000);
    EXPECT_EQ(rig.state(), OperatingState::Active);
  }
  void expect_nothing_pushed() {
    for (const Force3& force : rig.device.written) ASSERT_EQ(force, Force3{});
  }
  DrivenRig rig;
};

}  // namespace thimble::servo
