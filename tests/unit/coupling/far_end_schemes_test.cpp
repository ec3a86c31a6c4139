// What every scheme that computes at the far end promises, whatever its law.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fake_box.hpp"
#include "far_end_schemes.hpp"
#include "linked_loop.hpp"
#include "turned_world.hpp"

namespace thimble::coupling {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::delayed_by;
using testing::FakeBox;
using testing::far_end_schemes;
using testing::FarEndScheme;
using testing::LinkedLoop;

constexpr double kHalf_m = 0.015;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A scheme between a hand and the plainest box there is.
struct Rig {
  explicit Rig(const FarEndScheme& scheme, Duration dt = milliseconds(1), double delay_s = 0.02)
      : arm(scheme.make_arm()),
        world(scheme.make_world(box, 7)),
        loop(*arm, *world, dt, delayed_by(delay_s)) {}

  // Moves from `tip` to `to_m` along x at 0.1 m/s, then rests there for `rest`.
  ArmOutput push_to(double to_m, Duration rest) {
    const double step_m = 0.1 * seconds(loop.dt());
    ArmOutput out;
    while (std::abs(to_m - tip.x) > step_m) {
      const double sign = to_m > tip.x ? 1 : -1;
      tip.x += sign * step_m;
      out = loop.tick(tip, {sign * 0.1, 0, 0});
    }
    return hold(rest);
  }
  ArmOutput hold(Duration rest) {
    ArmOutput out;
    for (Duration t{}; t < rest; t += loop.dt()) out = loop.tick(tip, {});
    return out;
  }

  FakeBox box{kHalf_m};
  std::unique_ptr<ArmCoupling> arm;
  std::unique_ptr<WorldCoupling> world;
  LinkedLoop loop;
  Position3 tip{};
};

Position3 wandering(double t_s) {
  return {0.020 * std::sin(2.1 * t_s), 0.018 * std::sin(1.3 * t_s + 1) - 0.018 * std::sin(1),
          0.017 * std::sin(0.7 * t_s + 2) - 0.017 * std::sin(2)};
}
Velocity3 wandering_speed(double t_s) {
  return {0.020 * 2.1 * std::cos(2.1 * t_s), 0.018 * 1.3 * std::cos(1.3 * t_s + 1),
          0.017 * 0.7 * std::cos(0.7 * t_s + 2)};
}

TEST(FarEndSchemes, PushBackWhereTheWallIs) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    Rig rig(scheme);
    EXPECT_NEAR(rig.push_to(0.014, milliseconds(1500)).force.x, 0, 0.02);
    const ArmOutput out = rig.push_to(0.020, milliseconds(1500));
    EXPECT_LT(out.force.x, -0.2);
    EXPECT_TRUE(out.is_in_contact);
    EXPECT_EQ(out.offset, Displacement3{});
    EXPECT_NEAR(rig.push_to(0, milliseconds(1500)).force.x, 0, 0.02);
  }
}

TEST(FarEndSchemes, FeelTheSameAtAnyServoRate) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    const auto run = [&](int rate_hz) {
      Rig rig(scheme, microseconds(1'000'000 / rate_hz), 0.04);
      std::vector<Force3> felt;
      for (Duration t{}; t < std::chrono::seconds(6); t += rig.loop.dt()) {
        const ArmOutput out = rig.loop.tick(wandering(seconds(t)), wandering_speed(seconds(t)));
        if (t % milliseconds(50) == Duration::zero()) felt.push_back(out.force);
      }
      return felt;
    };
    const auto reference = run(8000);
    const auto hardest = std::max_element(reference.begin(), reference.end(),
                                          [](Force3 a, Force3 b) { return norm(a) < norm(b); });
    EXPECT_GT(norm(*hardest), 0.5) << scheme.name;
    for (const int rate_hz : {500, 1000, 4000}) {
      const auto felt = run(rate_hz);
      ASSERT_EQ(felt.size(), reference.size());
      for (std::size_t i = 0; i < felt.size(); ++i) {
        EXPECT_LT(norm(felt[i] - reference[i]), 0.1 * norm(*hardest))
            << scheme.name << ", " << rate_hz << " Hz, " << 50 * i << " ms";
      }
    }
  }
}

testing::TurnedTrace feel_turned(const FarEndScheme& scheme, world::World& world,
                                 const world::Symmetry& turn) {
  const auto arm = scheme.make_arm();
  const auto far = scheme.make_world(world, 7);
  LinkedLoop loop(*arm, *far, milliseconds(1), delayed_by(0.03));
  testing::TurnedTrace trace;
  for (int i = 0; i < 6000; ++i) {
    const Position3 tip = testing::about(1e-3 * i);
    const Velocity3 velocity = testing::about_speed(1e-3 * i);
    trace.emplace_back(turn, loop.tick(image(turn, tip), image(turn, velocity)));
  }
  EXPECT_GT(testing::ticks_felt(trace), 1000);
  return trace;
}

// teleop.md 8.
TEST(FarEndSchemes, MirroredAndPermutedWorldsGiveMirroredAndPermutedForces) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    const auto feel = [&](world::World& world, const world::Symmetry& turn) {
      return feel_turned(scheme, world, turn);
    };
    FakeBox box(kHalf_m);
    testing::expect_turned_is_felt_turned(box, feel, 0);
    world::SphereWorld ball = testing::make_ball();
    testing::expect_turned_is_felt_turned(ball, feel, 1e-6);
  }
}

TEST(FarEndSchemes, ASilentWorldIsHeldThenFadesThenIsForgotten) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    Rig rig(scheme);
    const double held_newton = norm(rig.push_to(0.020, milliseconds(1000)).force);
    rig.loop.is_up = false;
    const ArmOutput held = rig.hold(milliseconds(200));
    EXPECT_TRUE(held.is_frozen);
    EXPECT_LE(norm(held.force), held_newton + 0.01);
    if (scheme.keeps_force) {
      EXPECT_GT(norm(held.force), 0.5 * held_newton);
    } else {
      EXPECT_LT(norm(held.force), 0.001);
    }
    double last_newton = norm(held.force);
    for (int i = 0; i < 250; ++i) {
      const ArmOutput out = rig.hold(milliseconds(1));
      EXPECT_LE(norm(out.force), last_newton + 1e-12);
      EXPECT_GE(norm(out.force), last_newton - 0.011 * held_newton - 1e-12);
      last_newton = norm(out.force);
    }
    EXPECT_EQ(last_newton, 0);
    const ArmOutput gone = rig.hold(milliseconds(1));
    EXPECT_TRUE(gone.is_fading);
    EXPECT_FALSE(gone.is_in_contact);
  }
}

TEST(FarEndSchemes, AfterAnOutageTheForceRisesSlowlyFromNothing) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    Rig rig(scheme);
    rig.push_to(0.010, milliseconds(500));
    rig.loop.is_up = false;
    rig.push_to(0.022, milliseconds(600));  // into the wall while nothing is told
    rig.loop.is_up = true;
    double last_newton = 0;
    double most_newton = 0;
    for (int i = 0; i < 1500; ++i) {
      const ArmOutput out = rig.hold(milliseconds(1));
      EXPECT_LE(norm(out.force), last_newton + 0.15) << i;
      last_newton = norm(out.force);
      most_newton = std::max(most_newton, last_newton);
    }
    EXPECT_GT(most_newton, 0.05) << "and the wall is felt again";
  }
}

TEST(FarEndSchemes, AWorldThatRestartedIsANewEpochWithoutAKick) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    Rig rig(scheme);
    const ArmOutput before = rig.push_to(0.020, milliseconds(1000));
    (void)rig.world->open(before.sample);  // its next answer is of another session
    double last_newton = norm(before.force);
    double least_newton = last_newton;
    for (int i = 0; i < 1500; ++i) {
      const ArmOutput out = rig.hold(milliseconds(1));
      EXPECT_LE(norm(out.force), last_newton + 0.15) << i;
      last_newton = norm(out.force);
      least_newton = std::min(least_newton, last_newton);
    }
    EXPECT_LT(least_newton, 0.02 * norm(before.force));
    EXPECT_GT(last_newton, 0.05);
  }
}

TEST(FarEndSchemes, ATipThatIsNotFiniteGivesAForceThatIsNotAndLeavesTheStateAsItWas) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    Rig rig(scheme);
    Rig twin(scheme);
    rig.push_to(0.018, milliseconds(300));
    twin.push_to(0.018, milliseconds(300));
    for (const auto& [tip, velocity] :
         {std::pair<Position3, Velocity3>{{kNan, 0, 0}, {}}, {{}, {0, kNan, 0}}}) {
      EXPECT_TRUE(std::isnan(rig.arm
                                 ->step({.now = rig.loop.now(),
                                         .dt = milliseconds(1),
                                         .tip = tip,
                                         .tip_velocity = velocity})
                                 .force.x));
    }
    EXPECT_EQ(rig.hold(milliseconds(5)).force, twin.hold(milliseconds(5)).force);
  }
}

TEST(FarEndSchemes, AReplyThatIsNotSoundIsAsGoodAsNone) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    const auto arm = scheme.make_arm();
    arm->reset({}, {});
    for (int i = 1; i < 500; ++i) {
      ConstraintSet bad;
      bad.sequence = static_cast<std::uint64_t>(i);
      bad.session = 3;
      bad.has_far = i % 4 != 0;
      bad.far.force = {0, i % 4 == 1 ? kNan : 0, 0};
      bad.far.slave = {i % 4 == 2 ? 1e300 : 0, 0, 0};
      bad.far.waves.joule[2] = i % 4 == 3 ? -1 : 0;
      const ArmOutput out = arm->step({.now = {milliseconds(i)},
                                       .dt = milliseconds(1),
                                       .tip = {0.001, 0, 0},
                                       .tip_velocity = {0.1, 0, 0},
                                       .fresh = &bad});
      ASSERT_EQ(out.force, Force3{}) << i;
      ASSERT_EQ(out.is_fading, i > 250) << i;
      ASSERT_EQ(out.sample.applied_reply, 0U);
    }
  }
}

TEST(FarEndSchemes, AWorldThatCannotSayLooksSilent) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    Rig rig(scheme);
    rig.push_to(0.018, milliseconds(300));
    rig.box.is_silent = true;
    EXPECT_TRUE(rig.hold(milliseconds(500)).is_fading);
    EXPECT_EQ(rig.hold(milliseconds(1)).force, Force3{});
    rig.box.is_silent = false;
    EXPECT_LT(rig.hold(milliseconds(1500)).force.x, -0.05);
  }
}

TEST(FarEndSchemes, HandsTheProbeBackAndRefusesAHandThatIsNowhere) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    FakeBox box(kHalf_m);
    {
      const auto world = scheme.make_world(box, 1);
      HandSample first;
      first.hand.x = kNan;
      EXPECT_EQ(world->open(first).error().code, Errc::InvalidArgument);
      first.hand.x = 0;
      ASSERT_TRUE(world->open(first));
      ASSERT_TRUE(world->open(first));
      EXPECT_EQ(box.probes, 1);
      box.is_full = true;
      EXPECT_EQ(world->open(first).error().code, Errc::Busy);
      EXPECT_EQ(box.probes, 0);
      box.is_full = false;
      ASSERT_TRUE(world->open(first));
    }
    EXPECT_EQ(box.probes, 0);
  }
}

TEST(FarEndSchemes, PressesButtonsInTheWorldOnce) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    FakeBox box(kHalf_m);
    const auto world = scheme.make_world(box, 1);
    HandSample sample;
    ASSERT_TRUE(world->open(sample));
    for (const std::uint32_t buttons : {0U, 2U, 2U, 3U, 0U}) {
      ++sample.sequence;
      sample.buttons = buttons;
      (void)world->answer(sample, milliseconds(1));
    }
    EXPECT_EQ(box.presses, (std::vector<std::uint32_t>{0, 2, 0, 1, 0}));
  }
}

TEST(FarEndSchemes, AskOfTheWorldWhatIsAskedByTheHand) {
  for (const FarEndScheme& scheme : far_end_schemes()) {
    SCOPED_TRACE(scheme.name);
    FakeBox box(kHalf_m);
    const auto world = scheme.make_world(box, 1);
    HandSample sample;
    ASSERT_TRUE(world->open(sample));
    sample.has_actions = true;
    for (const int count : {0, 1, 1, 2}) {
      ++sample.sequence;
      sample.actions = {static_cast<std::uint8_t>(count), 0};
      (void)world->answer(sample, milliseconds(1));
    }
    EXPECT_EQ(box.asked, (std::array<unsigned, world::kHandActions>{2, 0}));
  }
}

}  // namespace
}  // namespace thimble::coupling
