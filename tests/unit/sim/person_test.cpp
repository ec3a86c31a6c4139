#include "sim/model/hand/person.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/model/arm/phantom_arm_model.hpp"
#include "sim/time/trace_hash.hpp"
#include "tests/unit/sim/usb_frames.hpp"

namespace thimble::sim {
namespace {

constexpr plugin::SimModelSettings kSettings{.amplifier_max_a = 3, .seed = 0};

class PersonAt : public testing::TestWithParam<ArmParameters> {
 protected:
  PhantomArmModel arm{GetParam(), kSettings};
  UsbFrames usb{arm};

  double error_m(Position3 target) { return norm(arm.truth().tip - target); }
};
INSTANTIATE_TEST_SUITE_P(Models, PersonAt,
                         testing::Values(phantom_vintage_parameters(), woody_2015_parameters()),
                         [](const auto& of) {
                           return std::string(of.index == 0 ? "PhantomVintage" : "Woody2015");
                         });

TEST_P(PersonAt, BringsTheArmHomeBeforePressingTheButton) {
  ASSERT_GT(error_m(arm.home_position()), 0.01) << "parked elsewhere, or this proves nothing";
  Person sut(arm, {});
  int flagged_at_ms = 0;
  for (int ms = 0; ms < 690 && flagged_at_ms == 0; ++ms) {
    if (usb.frame(Fields{}).value_or(Fields{})[6] == 1) flagged_at_ms = ms;
    if (ms >= 500) {
      EXPECT_LT(error_m(arm.home_position()), 0.3e-3) << ms;
    }
  }
  EXPECT_GE(flagged_at_ms, 550);
  EXPECT_LE(flagged_at_ms, 553);
}

TEST_P(PersonAt, HoldsTheArmHomeLongEnoughToSetItsCounters) {
  Person sut(arm, {});
  bool is_set = false;
  for (int ms = 0; ms < 1150; ++ms) {
    const bool is_flagged = usb.frame(Fields{}).value_or(Fields{})[6] == 1;
    if (is_flagged && !is_set) {
      usb.frame(set_counters(100, 200, 300));
      is_set = true;
    }
    if (is_set) {
      EXPECT_LT(error_m(arm.home_position()), 0.3e-3) << ms;
    }
  }
  const Fields seen = usb.run_ms(3, Fields{});
  EXPECT_TRUE(is_set);
  EXPECT_NEAR(seen[0], 100, 8);
  EXPECT_NEAR(seen[1], 200, 8);
  EXPECT_NEAR(seen[2], 300, 8);
  EXPECT_EQ(seen[6], 0) << "pressed once";
}

TEST_P(PersonAt, ThenPlaysTheMotionAboutTheOrigin) {
  Person sut(arm, {.motion = HandMotion::Still});
  usb.silence_ms(1195);
  EXPECT_EQ(sut.phase(), Person::Phase::Waiting);
  usb.silence_ms(10);
  EXPECT_EQ(sut.phase(), Person::Phase::Moving);
  usb.silence_ms(3000);
  EXPECT_LT(error_m({}), 3e-3) << "arm friction and weight against a relaxed hand";
}

TEST(Person, StartsSoonerWhenToldButNotBeforeItLetGoOfTheButton) {
  PhantomArmModel arm(phantom_vintage_parameters(), kSettings);
  UsbFrames usb(arm);
  Person sut(arm, {});
  sut.start_motion();
  usb.silence_ms(690);
  EXPECT_EQ(sut.phase(), Person::Phase::Pressing);
  usb.silence_ms(15);
  EXPECT_EQ(sut.phase(), Person::Phase::Moving);
}

TEST(Person, CalibratesAgainAfterAPowerCut) {
  PhantomArmModel arm(phantom_vintage_parameters(), kSettings);
  UsbFrames usb(arm);
  Person sut(arm, {});
  usb.silence_ms(3000);
  arm.power_cycle();
  usb.silence_ms(1001);
  ASSERT_EQ(usb.run_ms(5, Fields{})[6], 0);

  sut.begin_calibration();

  EXPECT_EQ(usb.run_ms(500, Fields{})[6], 0);
  EXPECT_EQ(usb.run_ms(60, Fields{})[6], 1);
  EXPECT_LT(norm(arm.truth().tip - arm.home_position()), 0.3e-3);
}

TEST(Person, WhoIsAskedCalibratesOnceMoreButIsNotDisturbedAtIt) {
  PhantomArmModel arm(phantom_vintage_parameters(), kSettings);
  UsbFrames usb(arm);
  Person sut(arm, {});
  usb.silence_ms(300);
  sut.ask_to_calibrate();
  usb.silence_ms(260);
  EXPECT_EQ(sut.phase(), Person::Phase::Pressing) << "not begun anew";
  usb.silence_ms(1000);
  ASSERT_EQ(sut.phase(), Person::Phase::Moving) << "the old request is spent";

  sut.ask_to_calibrate();

  usb.silence_ms(2);
  EXPECT_EQ(sut.phase(), Person::Phase::GoingHome);
  usb.silence_ms(560);
  EXPECT_EQ(sut.phase(), Person::Phase::Pressing);
}

TEST(Person, LetsGoWhenGone) {
  PhantomArmModel arm(phantom_vintage_parameters(), kSettings);
  UsbFrames usb(arm);
  {
    Person sut(arm, {});
    usb.silence_ms(600);
  }
  const Position3 before = arm.truth().tip;
  usb.silence_ms(1000);
  EXPECT_LT(norm(arm.truth().tip - before), 1e-3);
}

TEST(Person, NeverMovesTheTipFasterThanAMetrePerSecond) {
  for (const HandMotion motion : kHandMotions) {
    PhantomArmModel arm(phantom_vintage_parameters(), kSettings);
    UsbFrames usb(arm);
    HandSettings settings;
    settings.motion = motion;
    settings.speed_m_per_s = 0.5;  // the fastest that is allowed
    Person sut(arm, settings);
    double fastest = 0;
    for (int ms = 0; ms < 4000; ++ms) {
      usb.frame(Fields{});
      fastest = std::max(fastest, norm(arm.truth().tip_velocity));
    }
    EXPECT_LT(fastest, 1) << to_string(motion);
    EXPECT_GT(fastest, 0.1) << to_string(motion);
  }
}

TEST(Person, ReachesTheWallsOfTheBoxOnEverySide) {
  PhantomArmModel arm(phantom_vintage_parameters(), kSettings);
  UsbFrames usb(arm);
  Person sut(arm, {});
  Position3 low{}, high{};
  for (int ms = 0; ms < 15'000; ++ms) {
    usb.frame(Fields{});
    if (sut.phase() != Person::Phase::Moving) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], arm.truth().tip[axis]);
      high[axis] = std::max(high[axis], arm.truth().tip[axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_LT(low[axis], -0.016);
    EXPECT_GT(high[axis], 0.016);
  }
}

TEST(Person, FeelsTheMotorsAndGivesWay) {
  // About 1 N along x against a hand of 200 N/m moves it by 5 mm, less what friction holds.
  PhantomArmModel arm(phantom_vintage_parameters(), kSettings);
  UsbFrames usb(arm);
  Person sut(arm, {.motion = HandMotion::Still});
  usb.run_ms(2500, Fields{});
  const Position3 before = arm.truth().tip;

  usb.run_ms(2000, currents(1000, 0, 0));

  const plugin::ArmTruth truth = arm.truth();
  const double friction = arm.plant().dynamics().parameters().backdrive_newton;
  EXPECT_GT(norm(truth.motor_force), 0.7);
  const double expected = truth.motor_force.x / 200;
  EXPECT_NEAR(truth.tip.x - before.x, expected, 0.05 * expected + 2 * friction / 200);
  EXPECT_NEAR(sut.hand().force().x, -truth.motor_force.x, 1.1 * friction);
}

TEST(Person, SameSeedGivesTheSameTrace) {
  const auto trace_of = [](std::uint64_t seed) {
    PhantomArmModel arm(phantom_vintage_parameters(), kSettings);
    UsbFrames usb(arm);
    HandSettings settings;
    settings.seed = seed;
    Person sut(arm, settings);
    TraceHash trace;
    for (int ms = 0; ms < 3000; ++ms) {
      for (const std::int16_t field : usb.frame(Fields{}).value_or(Fields{})) trace.add(field);
      trace.add(arm.truth().tip.x);
    }
    return trace.value();
  };
  EXPECT_EQ(trace_of(1), trace_of(1));
  EXPECT_NE(trace_of(1), trace_of(2));
}

}  // namespace
}  // namespace thimble::sim
