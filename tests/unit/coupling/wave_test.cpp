#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>

#include "daemon/coupling/wave_arm.hpp"
#include "daemon/coupling/wave_world.hpp"
#include "fake_box.hpp"
#include "finger.hpp"
#include "linked_loop.hpp"
#include "watched_waves.hpp"

namespace thimble::coupling {
namespace {

using testing::delayed_by;
using testing::FakeBox;
using testing::Finger;
using testing::LinkedLoop;
using testing::Reference;
using testing::WatchedWaves;

constexpr double kServo_s = 1e-3;
constexpr double kFar_m = 1000;  // a box without walls
constexpr double kBox_m = 0.015;

// Both halves of it on a link.
struct Waves {
  Waves(const WaveSettings& settings, const link::ImpairmentSettings& impairment,
        double half_m = kFar_m, const WaveWorldSettings& world_settings = {},
        Duration servo = Finger::kServo)
      : arm(settings),
        box(half_m),
        world(box, 1, world_settings),
        loop(arm, world, servo, impairment) {}

  ArmOutput tick(double x_m, double v_m_per_s) { return loop.tick({x_m, 0, 0}, {v_m_per_s, 0, 0}); }
  [[nodiscard]] double servo_s() const { return seconds(loop.dt()); }
  [[nodiscard]] int ticks(double for_s) const {
    return static_cast<int>(std::lround(for_s / servo_s()));
  }

  WaveArm arm;
  FakeBox box;
  WaveWorld world;
  LinkedLoop loop;
};

WaveSettings of_impedance(double b) { return {.impedance = {b}}; }
WaveSettings unfiltered(double b) { return {.impedance = {b}, .filter = {}, .filter_share = 0}; }

// The theory's slave has no mass, which this one comes near to.
constexpr double kLightSlave_kg = 0.02;
WaveWorldSettings light_slave() { return {.slave = {.mass_kg = kLightSlave_kg}}; }

// What theory says of waves, and what they promise, holds at each.
class WaveAtEachRate : public ::testing::TestWithParam<int> {
 protected:
  [[nodiscard]] static Duration servo() {
    return std::chrono::microseconds(1'000'000 / GetParam());
  }
};
INSTANTIATE_TEST_SUITE_P(, WaveAtEachRate, ::testing::Values(500, 1000, 4000),
                         [](const auto& of) { return std::to_string(of.param) + "Hz"; });

// What a hand feels that swings slowly in free space, less the slave's own mass, kg.
double felt_mass_kg(Waves& sut, double one_way_s) {
  const double omega = 0.1 / one_way_s;  // b·tan(ωT) is b·ωT within 0.4 %
  const int period = sut.ticks(2 * std::numbers::pi / omega);
  double in_phase = 0;
  for (int i = 0; i < 3 * period; ++i) {
    const double phase = omega * sut.servo_s() * i;
    const ArmOutput out = sut.tick(0.02 * std::sin(phase), 0.02 * omega * std::cos(phase));
    if (i >= period) in_phase += out.force.x * std::sin(phase);
  }
  return in_phase / period / (0.02 * omega * omega) - kLightSlave_kg;
}

// teleop.md 2(c): b·T within 10 %.
TEST_P(WaveAtEachRate, InFreeSpaceIsFeltAsAMassOfImpedanceTimesDelay) {
  for (const double b : {2.0, 10.0, 40.0}) {
    for (const double one_way_s : {0.02, 0.05, 0.1}) {
      Waves sut(unfiltered(b), delayed_by(2 * one_way_s), kFar_m, light_slave(), servo());
      const double kg = felt_mass_kg(sut, one_way_s);
      EXPECT_NEAR(kg, b * one_way_s, 0.1 * b * one_way_s) << b << ", " << one_way_s;
      RecordProperty("mass_b_" + std::to_string(static_cast<int>(b)) + "_T_" +
                         std::to_string(static_cast<int>(1e3 * one_way_s)),
                     std::to_string(kg));
    }
  }
}

TEST_P(WaveAtEachRate, TheFilterMakesTheDelayThatMuchLonger) {
  Waves sut({.impedance = {10}, .filter_share = 1}, delayed_by(0.1), kFar_m, light_slave(),
            servo());
  EXPECT_NEAR(felt_mass_kg(sut, 0.05), 10 * 0.075, 0.1 * 10 * 0.075);
}

// What a hand feels that stands `depth_m` deep in a wall, N/m.
double felt_stiffness(Waves& sut, double depth_m) {
  double x_m = 0;
  double newton = 0;
  for (int i = 0; i < sut.ticks(12); ++i) {
    const double v = x_m < kBox_m + depth_m ? 0.05 : 0;
    x_m += sut.servo_s() * v;
    newton = -sut.tick(x_m, v).force.x;
  }
  return newton / (x_m - kBox_m);
}

// b/T within 10 %, when the slave's controller and the wall, in series with it, are taken off.
TEST_P(WaveAtEachRate, InContactIsFeltAsAStiffnessOfImpedanceByDelay) {
  const double others = 1 / WaveWorldSettings{}.stiffness.newton_per_m + 1 / 800.0;
  for (const double b : {2.0, 10.0, 40.0}) {
    for (const double one_way_s : {0.02, 0.05, 0.1}) {
      Waves sut(unfiltered(b), delayed_by(2 * one_way_s), kBox_m, {}, servo());
      const double felt = felt_stiffness(sut, 0.01);
      const double theory = b / one_way_s;
      EXPECT_NEAR(1 / (1 / felt - others), theory, 0.1 * theory) << b << ", " << one_way_s;
      RecordProperty("felt_b_" + std::to_string(static_cast<int>(b)) + "_T_" +
                         std::to_string(static_cast<int>(1e3 * one_way_s)),
                     std::to_string(felt) + " beside " + std::to_string(1 / (1 / theory + others)));
    }
  }
}

// The same two of the settings as shipped. The filter is in the way back, so of the round trip
// 2·T: b·tanh(s·T) of teleop.md 2(c) with 1/(1 + s/λ) there is, for slow hands, that of T + 1/(2λ);
// and half a period more of the servo that holds each wave, as in 2(a): 1 ms of 500 Hz beside 5 ms.
TEST_P(WaveAtEachRate, AsShippedTheFilterIsHalfOfItsTimeOfDelay) {
  const WaveSettings shipped;
  const double b = shipped.impedance.newton_s_per_m;
  const double others = 1 / WaveWorldSettings{}.stiffness.newton_per_m + 1 / 800.0;
  for (const double one_way_s : {0.005, 0.02, 0.05, 0.1}) {
    const double filter_s = std::max(seconds(shipped.filter), shipped.filter_share * one_way_s);
    const double longer_s = one_way_s + filter_s / 2 + seconds(servo()) / 2;
    Waves in_space(shipped, delayed_by(2 * one_way_s), kFar_m, light_slave(), servo());
    const double kg = felt_mass_kg(in_space, one_way_s);
    EXPECT_NEAR(kg, b * longer_s, 0.1 * b * longer_s) << one_way_s;
    Waves at_wall(shipped, delayed_by(2 * one_way_s), kBox_m, {}, servo());
    const double felt = 1 / (1 / felt_stiffness(at_wall, 0.01) - others);
    EXPECT_NEAR(felt, b / longer_s, 0.1 * b / longer_s) << one_way_s;
  }
}

TEST_P(WaveAtEachRate, BeforeTheFirstAnswerADamperIsFelt) {
  Waves sut(of_impedance(10), delayed_by(0.1), kFar_m, {}, servo());
  for (int i = 0; i < sut.ticks(1); ++i) sut.tick(0, 0);
  for (int i = 1; i < sut.ticks(0.095); ++i) {
    EXPECT_NEAR(sut.tick(0.1 * sut.servo_s() * i, 0.1).force.x, -10 * 0.1, 0.05);
  }
}

TEST(Wave, InAGapADamperIsFeltAndByAHandAtRestNothing) {
  Waves sut(of_impedance(10), delayed_by(0.02), kBox_m);
  double x_m = 0;
  for (; x_m < kBox_m + 0.005; x_m += 1e-4) sut.tick(x_m, 0.1);
  ArmOutput out;
  for (int i = 0; i < 1000; ++i) out = sut.tick(x_m, 0);
  EXPECT_LT(out.force.x, -0.5) << "the wall";
  sut.loop.is_up = false;
  for (int i = 0; i < 100; ++i) out = sut.tick(x_m, 0);
  EXPECT_NEAR(out.force.x, 0, 0.001);
  for (const double v : {-0.1, 0.1}) {
    for (int i = 0; i < 50; ++i) out = sut.tick(x_m += kServo_s * v, v);
    EXPECT_NEAR(out.force.x, -10 * v, 0.05);
  }
  EXPECT_FALSE(out.is_fading);
}

struct Course {
  double swing_m{0};  // in the last half second of the hold
  double hold_newton{0};
  double generated_joule{0};
};

// `longer_ticks`: held for so much longer than Reference has it.
Course push(double b, const link::ImpairmentSettings& impairment, int longer_ticks = 0) {
  Waves sut(of_impedance(b), impairment, kBox_m);
  Finger finger(-0.015);
  Reference reference;
  Course course;
  double least_m = 1;
  double most_m = -1;
  const int hold_to = Reference::kHoldTo_tick + longer_ticks;
  // Before 0 both ends get to know each other.
  for (int i = -1500; i < Reference::kTicks + longer_ticks; ++i) {
    if (i >= 0) reference.advance(i < hold_to ? std::min(i, Reference::kHoldFrom_tick) : i);
    const Finger::Sight seen = finger.look();
    const ArmOutput out = sut.tick(seen.x_m, seen.v_m_per_s);
    finger.move(reference.x_m, reference.v_m_per_s, out.force.x);
    if (i < hold_to - 500 || i >= hold_to) continue;
    least_m = std::min(least_m, finger.x_m());
    most_m = std::max(most_m, finger.x_m());
    course.hold_newton = -out.force.x;
  }
  course.swing_m = most_m - least_m;
  course.generated_joule = finger.energy().generated_joule();
  return course;
}

// teleop.md 5, gates G1 and G2. The microjoule is ours, for rounding: the 1 mJ of G2 is for schemes
// that shift a frame.
TEST(Wave, AHandHoldsStillAtAnyDelayAndIsGivenNoEnergy) {
  for (const double b : {2.0, 10.0, 40.0}) {
    for (const int delay_ms : {1, 5, 20, 50, 100, 200, 500}) {
      // Eight round trips of half a second more: b = 40 takes that long to come to rest.
      const Course course = push(b, delayed_by(1e-3 * delay_ms), delay_ms == 500 ? 4000 : 0);
      EXPECT_LT(course.swing_m, 0.0005) << b << ", " << delay_ms << " ms";
      EXPECT_GT(course.hold_newton, 0.1) << b << ", " << delay_ms << " ms";
      EXPECT_LT(course.generated_joule, 1e-6) << b << ", " << delay_ms << " ms";
    }
  }
}

TEST(Wave, JitterLossAndReorderingGiveTheHandNoEnergyEither) {
  for (const int delay_ms : {20, 100, 200}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const double delay_s = 1e-3 * delay_ms;
      const Course course = push(10, {.delay_s = delay_s,
                                      .jitter_s = 0.5 * delay_s,
                                      .loss = 0.05,
                                      .duplicate = 0.02,
                                      .reorder = 0.05,
                                      .seed = seed});
      EXPECT_LT(course.generated_joule, 0.001) << delay_ms << " ms, seed " << seed;
    }
  }
}

Position3 roam(double t_s) {
  return {0.022 * std::sin(2.1 * t_s), 0.020 * std::sin(3.3 * t_s), 0.018 * std::sin(1.7 * t_s)};
}

// By the counters, by what went over the wire, and by force and way at both ends.
void expect_passive(const WatchedWaves& sut) {
  constexpr double kRounding = 1 + 1e-9;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ASSERT_LE(sut.world.incoming().taken().joule[axis], sut.arm.sent().joule[axis]);
    ASSERT_LE(sut.arm.incoming().taken().joule[axis], sut.world.sent().joule[axis]);
    ASSERT_LE(sut.far_end.came_out.joule(axis), kRounding * sut.went_in.joule(axis));
    ASSERT_LE(sut.came_out.joule(axis), kRounding * sut.far_end.went_in.joule(axis));
  }
  ASSERT_LE(sut.far_end.slave_joule(), sut.hand_joule + 1e-9);
}

// teleop.md 2(c): E_in >= E_out at every sample; and what was sent arrives in the end: no drift.
TEST_P(WaveAtEachRate, NoWayGivesOutMoreEnergyThanWentInAndTheSlaveEndsWhereTheHandIs) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    WatchedWaves sut(of_impedance(10),
                     {.delay_s = 0.08,
                      .jitter_s = 0.04,
                      .loss = 0.1,
                      .duplicate = 0.05,
                      .reorder = 0.1,
                      .seed = seed},
                     kBox_m, servo());
    for (int i = 0; i < GetParam(); ++i) sut.move({});  // until the force has risen
    for (int i = 1; i <= 15 * GetParam(); ++i) {
      const int tune_at = 4 * GetParam();
      if (i % tune_at == 0) sut.arm.set_impedance({i % (2 * tune_at) == 0 ? 3.0 : 30.0});
      sut.move(roam(seconds(servo()) * i));
      ASSERT_NO_FATAL_FAILURE(expect_passive(sut)) << seed << ", " << i;
    }
    EXPECT_GT(sut.hardest_newton, 0.5);
    EXPECT_GT(sut.far_end.slave_joule(), 0.001) << "a wall is met, or nothing is shown";
    const Position3 rest{0.003, -0.002, 0.001};
    sut.move(sut.at);
    for (int i = 0; i < 10 * GetParam(); ++i) sut.loop.tick(rest, {});
    EXPECT_LT(norm(sut.world.slave().at() - rest), 0.0005) << seed;
  }
}

// However b is turned, and whenever: no energy comes out of either end that did not go in.
TEST_P(WaveAtEachRate, ImpedanceTunedAtAnyMomentGivesTheHandNoEnergy) {
  std::mt19937_64 random(640);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Waves sut(of_impedance(10),
              {.delay_s = 0.1 * static_cast<double>(random() % 3),
               .jitter_s = seed % 2 == 0 ? 0.03 : 0,
               .loss = seed % 3 == 0 ? 0.1 : 0,
               .seed = seed},
              seed % 4 == 0 ? kFar_m : kBox_m, {}, servo());
    for (int i = 0; i < sut.ticks(0.8); ++i) sut.tick(0, 0);  // until the force has risen
    double t_s = 0;
    double x_m = 0;
    double given_joule = 0;
    int tuned = 0;
    for (int i = 0; i < sut.ticks(6); ++i, t_s += sut.servo_s()) {
      if (random() % static_cast<unsigned>(sut.ticks(0.15)) == 0) {
        ++tuned;
        sut.arm.set_impedance(
            {std::exp(std::uniform_real_distribution<double>(-2.3, 3.7)(random))});
      }
      const double next_m = roam(t_s + sut.servo_s()).x;
      const ArmOutput out = sut.tick(x_m, (next_m - x_m) / sut.servo_s());
      given_joule += out.force.x * (next_m - x_m);
      x_m = next_m;
      ASSERT_LE(given_joule, 0) << seed << ", " << i;
      ASSERT_LE(sut.world.incoming().taken().joule[0], sut.arm.sent().joule[0]) << i;
      ASSERT_LE(sut.arm.incoming().taken().joule[0], sut.world.sent().joule[0]) << i;
    }
    EXPECT_GT(tuned, 20);
    EXPECT_LT(given_joule, -0.0002) << "it takes some";
  }
}

TEST(Wave, ImpedanceIsTunedUnderForceWithoutAJumpAndFeltAtTheNextTouch) {
  Waves sut(of_impedance(2), delayed_by(0.1), kBox_m);
  const double soft = felt_stiffness(sut, 0.01);
  sut.arm.set_impedance({40});
  double last_newton = soft * 0.01;
  for (int i = 0; i < 3000; ++i) {
    const double newton = -sut.tick(kBox_m + 0.01, 0).force.x;
    ASSERT_LT(std::abs(newton - last_newton), 0.1) << i;
    last_newton = newton;
  }
  EXPECT_DOUBLE_EQ(sut.arm.impedance().newton_s_per_m, 40);
  for (int i = 0; i < 8000; ++i) sut.tick(0, 0);
  Waves as_new(of_impedance(40), delayed_by(0.1), kBox_m);
  const double hard = felt_stiffness(as_new, 0.01);
  EXPECT_GT(hard, 5 * soft) << "a drill instead of a sponge";
  EXPECT_NEAR(felt_stiffness(sut, 0.01), hard, 0.05 * hard);
}

// Each session of such a peer may bring a billion joules; sums beyond that are taken by nobody.
TEST(Wave, WhatAWildPeerMadeOfTheSumsIsForgottenWithIt) {
  WaveArm sut;
  sut.reset({}, {});
  ConstraintSet told;
  told.has_far = true;
  MonotonicTime now{};
  const auto hear = [&](const ConstraintSet* fresh) {
    now = now + std::chrono::milliseconds(1);
    return sut.step({.now = now,
                     .dt = std::chrono::milliseconds(1),
                     .tip = {},
                     .tip_velocity = {},
                     .buttons = 0,
                     .fresh = fresh,
                     .link = {true, std::chrono::milliseconds(1), {}}});
  };
  const std::uint32_t restart = hear(nullptr).sample.restart;
  for (; told.session < 1000 && sut.sent().joule[0] < 2e9; ++told.session) {
    told.far.waves = {};
    for (int blow = 0; blow < 9; ++blow) {
      ++told.sequence;
      told.far.waves.distance.x += 1e3;
      told.far.waves.joule[0] += 1e8;
      (void)hear(&told);
    }
  }
  ASSERT_GE(sut.sent().joule[0], 2e9);
  ArmOutput out;
  for (int i = 0; i < 2000; ++i) out = hear(nullptr);
  EXPECT_NE(out.sample.restart, restart) << "the far end is to begin anew, too";
  EXPECT_LT(out.sample.waves.joule[0], 1e-9);
  EXPECT_LT(std::abs(out.sample.waves.distance.x), 1e-9);
}

TEST(Wave, ImpedanceStaysWithinWhatAServoHolds) {
  WaveArm sut(of_impedance(1000));
  EXPECT_EQ(sut.impedance().newton_s_per_m, kMostImpedance_newton_s_per_m);
  sut.set_impedance({std::nan("")});
  sut.set_impedance({-3});
  sut.reset({}, {});
  EXPECT_EQ(sut.impedance().newton_s_per_m, kLeastImpedance_newton_s_per_m);
}

}  // namespace
}  // namespace thimble::coupling
