#include "sim/model/arm/phantom_arm_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include "drivers/phantom/phantom_wire.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "sim/time/trace_hash.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/unit/sim/usb_frames.hpp"

namespace thimble::sim {
namespace {

constexpr plugin::SimModelSettings kThreeAmperes{.amplifier_max_a = 3, .seed = 0};

ArmParameters still(ArmParameters p) {
  p.balance = 1;
  p.backdrive_newton = 5;  // stands wherever it is put
  return p;
}

// Pushes on the tip as told and remembers what it saw.
class Pusher final : public plugin::TipLoad {
 public:
  Force3 force_on_tip(MonotonicTime t, Duration dt, Position3 tip, Velocity3) noexcept override {
    if (calls > 0 && t - last_time != dt) ++gaps;
    last_time = t;
    last_tip = tip;
    ++calls;
    return force;
  }
  [[nodiscard]] bool is_button_pressed(MonotonicTime) const noexcept override { return button; }

  Force3 force{};
  bool button{false};
  int calls{0};
  int gaps{0};
  MonotonicTime last_time{};
  Position3 last_tip{};
};

TEST(PhantomArmModel, DescribesItselfAsTheBoardDoes) {
  const PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);

  const bus::BusDeviceInfo info = sut.describe();

  EXPECT_EQ(info.vendor_id, 0x1234);
  EXPECT_EQ(info.product_id, 0x0006);
  EXPECT_EQ(info.kind, bus::BusKind::Hid);
  EXPECT_EQ(info.input_report_bytes, 14U);
  EXPECT_EQ(info.output_report_bytes, 14U);
  EXPECT_FALSE(info.serial_number.empty()) << "shared ids: a configuration must name it";
  EXPECT_EQ(sut.frame_period(), Duration(1'000'000));
}

TEST(PhantomArmModel, IsMadeByTheRegistryUnderItsNames) {
  plugin::SimModelRegistry registry;
  register_arm_models(registry);
  for (const char* name :
       {"phantom-vintage", "woody-2015", "premium-1.5", "aluhaptics-2", "polhem-1"}) {
    const plugin::SimModelEntry* entry = registry.find(name);
    ASSERT_NE(entry, nullptr) << name;
    const auto model = entry->create_hid({});
    ASSERT_TRUE(model.has_value());
    EXPECT_NE((*model)->arm_backend(), nullptr);
    EXPECT_EQ((*model)->describe().address.text, std::string("sim:") + name);
    EXPECT_TRUE(entry->create_hid({.amplifier_max_a = phantom::wire::kLargestCurrentA, .seed = 0}));
    // A firmware for more could never be told to use it.
    for (const double wrong : {-1.0, 32.768, 1e6, std::nan("")}) {
      const auto refused = entry->create_hid({.amplifier_max_a = wrong, .seed = 0});
      ASSERT_FALSE(refused.has_value());
      EXPECT_EQ(refused.error().code, Errc::InvalidArgument);
    }
  }
}

TEST(PhantomArmModel, MovesItsTipWhereItIsToldAndCountsTheWay) {
  const ArmParameters p = still(phantom_vintage_parameters());
  PhantomArmModel sut(p, kThreeAmperes);
  UsbFrames usb(sut);
  ASSERT_TRUE(sut.move_tip_to(sut.home_position()));
  usb.run_ms(2, set_counters(0, 0, 0));
  usb.run_ms(2, Fields{});  // the last set is handled a frame later
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> around(-0.05, 0.05);
  for (int n = 0; n < 50; ++n) {
    const Position3 target{around(generator), around(generator), around(generator)};
    ASSERT_TRUE(sut.move_tip_to(target));

    const Fields seen = usb.run_ms(3, currents(0, 0, 0));

    EXPECT_LT(norm(sut.truth().tip - target), 1e-9);
    // Back to a tip by the sheet's formulas, from the counts alone.
    JointVector q{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double counts_per_turn = p.counts_per_motor_turn[i] * p.drive_ratio[i];
      q[i] = p.home_rad[i] + p.motor_sign[i] * 2 * std::numbers::pi * seen[i] / counts_per_turn;
    }
    const double radial = p.link_m[1] * std::sin(q[1]) + p.link_m[2] * std::sin(q[2]);
    EXPECT_NEAR(std::sin(q[0]) * radial - p.origin_m[1], target.x, 60e-6);
    EXPECT_NEAR(
        p.link_m[0] + p.link_m[1] * std::cos(q[1]) - p.link_m[2] * std::cos(q[2]) - p.origin_m[2],
        target.y, 60e-6);
    EXPECT_NEAR(std::cos(q[0]) * radial - p.origin_m[0], target.z, 60e-6);
  }
}

TEST(PhantomArmModel, EncodersAreQuantisedToWholeCountsOnBothSidesOfZero) {
  ArmParameters p = still(phantom_vintage_parameters());
  const double count_rad = 2 * std::numbers::pi / (p.counts_per_motor_turn[0] * p.drive_ratio[0]);
  for (const int counts : {-1000, -1, 0, 1, 12345}) {
    for (const double sign : {1.0, -1.0}) {
      p.motor_sign = {sign, sign, sign};
      // In the middle of a count, so that neither rounding nor the integrator decides.
      p.parked_rad = {0.5 * count_rad, p.home_rad[1], p.home_rad[2]};
      PhantomArmModel sut(p, kThreeAmperes);
      UsbFrames usb(sut);
      usb.run_ms(2, set_counters(0, 0, 0));
      usb.run_ms(2, Fields{});
      JointVector q = p.parked_rad;
      q[0] += counts * count_rad;
      if (q[0] > p.joint_range[0].max_rad) continue;
      const ArmDynamics& arm = sut.plant().dynamics();
      ASSERT_TRUE(sut.move_tip_to(arm.tip(ArmDynamics::pose(q))));

      EXPECT_EQ(usb.run_ms(3, Fields{})[0], sign * counts);
    }
  }
}

TEST(PhantomArmModel, RefusesTipsItCannotReachAndStaysWhereItIs) {
  PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);
  const Position3 before = sut.truth().tip;

  EXPECT_FALSE(sut.move_tip_to({0, 0, 1}));
  EXPECT_FALSE(sut.move_tip_to({std::nan(""), 0, 0}));

  EXPECT_EQ(sut.truth().tip, before);
}

TEST(PhantomArmModel, MotorsPushTheTipAsTheSheetSays) {
  // tau = s * I * Kt * drum / capstan per body; F from tau by virtual work at the home pose.
  for (ArmParameters p : all_arm_parameters()) {
    p.motor_sign = {1, -1, 1};
    PhantomArmModel sut(still(p), kThreeAmperes);
    UsbFrames usb(sut);
    ASSERT_TRUE(sut.move_tip_to(sut.home_position()));
    usb.run_ms(3, currents(400, -700, 1100));

    const plugin::ArmTruth truth = sut.truth();

    const std::array<double, 3> current_a{0.4, -0.7, 1.1};
    const TipJacobian j =
        sut.plant().dynamics().jacobian(ArmDynamics::pose(sut.plant().joint_rad()));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(truth.motor_current_a[i], current_a[i], 1e-3);
      const double torque = p.motor_sign[i] * p.torque_constant_newton_m_per_a[i] *
                            p.drive_ratio[i] * truth.motor_current_a[i];
      EXPECT_NEAR(j[0][i] * truth.motor_force.x + j[1][i] * truth.motor_force.y +
                      j[2][i] * truth.motor_force.z,
                  torque, 1e-9);
    }
  }
}

TEST(PhantomArmModel, ReportOfAFrameMovesNothingBeforeTheNext) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    PhantomArmModel sut(phantom_vintage_parameters(), {.amplifier_max_a = 3, .seed = seed});
    UsbFrames usb(sut);
    sut.move_tip_to(sut.home_position());
    usb.run_ms(3, currents(0, 0, 0));
    const Position3 before = sut.truth().tip;

    usb.frame(currents(3000, 0, 0));
    sut.advance(usb.now() + Duration(999'999));
    EXPECT_EQ(sut.truth().tip, before) << seed;
    EXPECT_EQ(sut.truth().motor_current_a[0], 0) << seed;

    usb.silence_ms(1);                           // the frame in which it may act,
    sut.advance(usb.now() + Duration(500'000));  // at the latest one PWM period on
    EXPECT_NEAR(sut.truth().motor_current_a[0], 3, 1e-3) << seed;
    usb.silence_ms(2);
    EXPECT_GT(norm(sut.truth().tip - before), 1e-7) << seed;
  }
}

TEST(PhantomArmModel, SaturatesAtTheAmplifiersFullScale) {
  PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);
  UsbFrames usb(sut);
  usb.run_ms(5, currents(32767, -32768, 3001));

  EXPECT_EQ(sut.truth().motor_current_a, (std::array<double, 3>{3, -3, 3}));
  EXPECT_GT(sut.counters().firmware.saturations, 0U);
}

TEST(PhantomArmModel, WatchdogStopsTheMotorsOfASilentHost) {
  PhantomArmModel sut(still(phantom_vintage_parameters()), kThreeAmperes);
  UsbFrames usb(sut);
  usb.run_ms(10, currents(1000, 0, 0));  // the last is handled at the next frame

  usb.silence_ms(500);
  EXPECT_TRUE(sut.truth().is_amplifier_on);
  usb.silence_ms(1);

  EXPECT_FALSE(sut.truth().is_amplifier_on);
  EXPECT_EQ(sut.truth().motor_force, Force3{});
}

TEST(PhantomArmModel, PowerCycleLosesCountersAndBootsForASecond) {
  PhantomArmModel sut(still(phantom_vintage_parameters()), kThreeAmperes);
  UsbFrames usb(sut);
  EXPECT_EQ(usb.run_ms(3, set_counters(1000, 2000, 3000))[0], 1000);
  const Position3 before = sut.truth().tip;

  sut.power_cycle();

  for (int i = 0; i < 999; ++i) ASSERT_FALSE(usb.frame(Fields{}).has_value()) << i;
  EXPECT_EQ(usb.frame(Fields{}), Fields{});
  EXPECT_LT(norm(sut.truth().tip - before), 1e-6) << "the arm stays where it was";
}

TEST(PhantomArmModel, AsksTheLoadOnceASubstepWithoutGaps) {
  PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);
  UsbFrames usb(sut);
  Pusher load;
  sut.hold_tip(&load);
  usb.silence_ms(11);

  EXPECT_EQ(load.calls, 100);
  EXPECT_EQ(load.gaps, 0);
  sut.hold_tip(nullptr);
  usb.silence_ms(1);
  EXPECT_EQ(load.calls, 100);
}

TEST(PhantomArmModel, PushAndLoadAddUp) {
  const auto run = [](Force3 push, Force3 held) {
    PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);
    UsbFrames usb(sut);
    Pusher load;
    load.force = held;
    sut.move_tip_to(sut.home_position());
    sut.hold_tip(&load);
    sut.push_tip(push);
    usb.silence_ms(50);
    return sut.truth().tip;
  };
  const Position3 pushed = run({1, 0, 0}, {});
  EXPECT_GT(pushed.x, 0.005);
  EXPECT_EQ(run({}, {1, 0, 0}), pushed);
  EXPECT_EQ(run({0.25, 0, 0}, {0.75, 0, 0}), pushed);
}

TEST(PhantomArmModel, NonFiniteForcesCountAndDoNothing) {
  PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);
  UsbFrames usb(sut);
  const Position3 before = sut.truth().tip;
  Pusher load;
  load.force.y = std::numeric_limits<double>::infinity();
  sut.push_tip({std::nan(""), 0, 0});
  sut.hold_tip(&load);
  usb.silence_ms(2);

  EXPECT_LT(norm(sut.truth().tip - before), 1e-9);
  EXPECT_EQ(sut.counters().non_finite_forces, 11U);
}

TEST(PhantomArmModel, CountsStylusPressesThatTheBoardCannotReport) {
  PhantomArmModel sut(still(phantom_vintage_parameters()), kThreeAmperes);
  UsbFrames usb(sut);
  Pusher load;
  sut.hold_tip(&load);
  usb.run_ms(3, Fields{});
  load.button = true;
  EXPECT_EQ(usb.run_ms(3, Fields{}), Fields{});
  load.button = false;
  usb.run_ms(3, Fields{});
  sut.press_stylus_button(true);
  EXPECT_EQ(usb.run_ms(3, Fields{}), Fields{});

  EXPECT_EQ(sut.counters().stylus_presses, 2U);
}

TEST(PhantomArmModel, TimeNeverRunsBackwards) {
  PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);
  UsbFrames usb(sut);
  sut.push_tip({1, 0, 0});
  usb.silence_ms(20);
  const Position3 before = sut.truth().tip;

  sut.advance(usb.now() - Duration(5'000'000));

  EXPECT_EQ(sut.truth().tip, before);
}

TEST(PhantomArmModel, AdvancesAlikeInOneStrideOrInMany) {
  const auto run = [](Duration stride) {
    PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);
    sut.push_tip({0.5, 0.2, -0.3});
    for (Duration t{0}; t <= Duration(60'000'000); t += stride) sut.advance({t});
    return sut.truth().tip;
  };
  EXPECT_EQ(run(Duration(1'000'000)), run(Duration(12'000'000)));
  EXPECT_EQ(run(Duration(1'000'000)), run(Duration(31'250)));
}

std::uint64_t trace_of(std::uint64_t seed) {
  PhantomArmModel sut(phantom_vintage_parameters(), {.amplifier_max_a = 3, .seed = seed});
  UsbFrames usb(sut);
  TraceHash trace;
  std::mt19937 generator(1);
  for (int i = 0; i < 2000; ++i) {
    const auto ma = static_cast<std::int16_t>(static_cast<int>(generator() % 2000) - 1000);
    const std::optional<Fields> in = usb.frame(currents(ma, static_cast<std::int16_t>(-ma), ma));
    for (const std::int16_t field : in.value_or(Fields{})) trace.add(field);
    const plugin::ArmTruth truth = sut.truth();
    for (std::size_t axis = 0; axis < 3; ++axis) trace.add(truth.tip[axis]);
  }
  return trace.value();
}

TEST(PhantomArmModel, SameSeedGivesTheSameTrace) {
  EXPECT_EQ(trace_of(3), trace_of(3));
  EXPECT_NE(trace_of(3), trace_of(4)) << "the seed shifts the PWM against the frames";
}

TEST(PhantomArmModel, AllocatesNothingOnceItRuns) {
  PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);
  UsbFrames usb(sut);
  usb.silence_ms(1);
  const std::uint64_t before = test::allocation_count();

  usb.run_ms(1000, currents(100, 200, 300));

  EXPECT_EQ(test::allocation_count(), before);
}

TEST(PhantomArmModel, GarbageFromTheHostNeverBreaksTheArm) {
  PhantomArmModel sut(phantom_vintage_parameters(), kThreeAmperes);
  UsbFrames usb(sut);
  std::mt19937 generator(9);
  std::array<std::uint8_t, 64> bytes{};
  for (int i = 0; i < 3000; ++i) {
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(generator());
    const std::size_t size = generator() % 4 == 0 ? generator() % 65 : 14;
    usb.frame_of_bytes({bytes.data(), size});
    const plugin::ArmTruth truth = sut.truth();
    ASSERT_TRUE(is_finite(truth.tip) && is_finite(truth.tip_velocity));
    ASSERT_LT(norm(truth.tip - Position3{}), 0.6);
  }
}

}  // namespace
}  // namespace thimble::sim
