#include "daemon/coupling/passivity_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "daemon/coupling/ghost_point_world.hpp"
#include "daemon/coupling/remote_force_arm.hpp"
#include "daemon/coupling/remote_force_world.hpp"
#include "daemon/coupling/scheme.hpp"
#include "daemon/world/voxel_world.hpp"
#include "fake_box.hpp"
#include "finger.hpp"
#include "hand_samples.hpp"
#include "linked_loop.hpp"
#include "turned_world.hpp"

namespace thimble::coupling {
namespace {

using testing::Finger;
using testing::kTick;
using testing::LinkedLoop;

// An arm half that wishes what a test says.
class Wisher final : public ArmCoupling {
 public:
  using Wish = std::function<Force3(const ArmInput&)>;
  explicit Wisher(Wish wish) : wish_(std::move(wish)) {}
  int resets{0};

 private:
  void restart(MonotonicTime /*now*/, Position3 /*tip*/) noexcept override { ++resets; }
  ArmOutput advance(const ArmInput& input) noexcept override {
    ArmOutput out;
    out.force = wish_(input);
    out.offset = {1, 2, 3};
    out.sample.sequence = ++sequence_;
    return out;
  }

  Wish wish_;
  std::uint64_t sequence_{0};
};

double any(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Velocity3 any_velocity(std::mt19937_64& random, double least_m_per_s) {
  while (true) {
    const Velocity3 v{any(random, -0.3, 0.3), any(random, -0.3, 0.3), any(random, -0.3, 0.3)};
    if (norm(v) >= least_m_per_s) return v;
  }
}

constexpr double kLargest = 1e9;
PassivitySettings uncapped() { return {.most = {kLargest}}; }

// A hand that moves as the servo sees it: work is what the forces do on its way.
struct Ledger {
  void note(Force3 force, Velocity3 velocity, Duration dt) {
    joule += dot(force, velocity) * seconds(dt);
    most_joule = std::max(most_joule, joule);
  }
  double joule{0};
  double most_joule{0};
};

TEST(PassivityGuard, AnyForceGivesAMovingHandNoMoreThanTheBound) {
  std::mt19937_64 random(630);
  for (int run = 0; run < 200; ++run) {
    const PassivitySettings settings = uncapped();
    const double hardest = any(random, 0.1, 9);
    const int bias = static_cast<int>(random() % 3) - 1;  // along the motion, against it, neither
    PassivityGuard sut(std::make_unique<Wisher>([&](const ArmInput& input) {
                         return Force3{any(random, -hardest, hardest),
                                       any(random, -hardest, hardest),
                                       any(random, -hardest, hardest)} +
                                Damping{10.0 * bias} * input.tip_velocity;
                       }),
                       settings);
    sut.reset({}, {});
    MonotonicTime now{};
    Position3 tip{};
    Ledger guarded;
    for (int i = 0; i < 2000; ++i) {
      const Duration dt = std::chrono::microseconds(250 << (random() % 4));
      const Velocity3 v = any_velocity(random, settings.least_m_per_s);
      now = now + dt;
      const ArmOutput out = sut.step({.now = now, .dt = dt, .tip = tip, .tip_velocity = v});
      tip = tip + Displacement3{v.x, v.y, v.z} * seconds(dt);
      guarded.note(out.force, v, dt);
    }
    EXPECT_LE(guarded.most_joule, settings.bound_joule + 1e-9) << run;
    EXPECT_EQ(sut.steps_at_most(), 0U);
  }
}

TEST(PassivityGuard, AtItsCapAndBelowItsSpeedTheHandIsGivenNoMoreThanUnguardedInAnyStep) {
  std::mt19937_64 random(631);
  std::uint64_t at_most = 0;
  for (int run = 0; run < 100; ++run) {
    Force3 wished{};
    PassivityGuard sut(std::make_unique<Wisher>([&](const ArmInput& input) {
                         wished = Damping{any(random, -2, 20)} * input.tip_velocity;
                         return wished;
                       }),
                       {});
    sut.reset({}, {});
    Position3 tip{};
    for (int i = 1; i <= 2000; ++i) {
      const Velocity3 v = any_velocity(random, 0) * any(random, 0, 0.2);
      const ArmOutput out =
          sut.step({.now = {kTick * i}, .dt = kTick, .tip = tip, .tip_velocity = v});
      tip = tip + Displacement3{v.x, v.y, v.z} * seconds(kTick);
      ASSERT_LE(dot(out.force, v), dot(wished, v) + 1e-12);
      const Force3 added = out.force - wished;
      ASSERT_LE(norm(added), 4.5 * norm(v) + 1e-12);
      if (norm(v) < PassivitySettings{}.least_m_per_s) {
        ASSERT_EQ(out.force, wished) << "no way is known";
      }
    }
    at_most += sut.steps_at_most();
  }
  EXPECT_GT(at_most, 1000U);
}

// Measured by places: velocities that are off by a filter do not add up.
TEST(PassivityGuard, AWrongVelocityCostsOneStepAndNoMore) {
  std::mt19937_64 random(632);
  PassivityGuard sut(std::make_unique<Wisher>(
                         [&](const ArmInput& input) { return Damping{5} * input.tip_velocity; }),
                     uncapped());
  sut.reset({}, {});
  Position3 tip{};
  double joule = 0;
  double most_in_a_step = 0;
  for (int i = 1; i <= 20000; ++i) {
    const Velocity3 v = any_velocity(random, 0.02);
    const ArmOutput out =
        sut.step({.now = {kTick * i}, .dt = kTick, .tip = tip, .tip_velocity = v});
    const Velocity3 off = any_velocity(random, 0) * 0.1;
    const Displacement3 way = Displacement3{v.x + off.x, v.y + off.y, v.z + off.z} * 1e-3;
    tip = tip + way;
    joule += dot(out.force, way);
    most_in_a_step = std::max(most_in_a_step, std::abs(dot(out.force, way)));
    ASSERT_LE(joule, PassivitySettings{}.bound_joule + most_in_a_step + 1e-9) << i;
  }
}

TEST(PassivityGuard, ASchemeThatGivesNothingIsNotChangedByABit) {
  const auto wall = [](const ArmInput& input) {
    const double depth_m = input.tip.x - 0.015;
    return Force3{
        -std::max(0.0, 800 * depth_m + 5 * input.tip_velocity.x) * (depth_m > 0 ? 1.0 : 0.0), 0, 0};
  };
  PassivityGuard sut(std::make_unique<Wisher>(wall), {});
  Wisher bare(wall);
  sut.reset({}, {});
  Position3 tip{};
  int felt = 0;
  for (int i = 1; i <= 20000; ++i) {
    const double t = 1e-3 * i;
    tip.x = 0.015 + 0.008 * std::sin(3 * t) * std::sin(0.7 * t);
    const double next = 0.015 + 0.008 * std::sin(3 * (t + 1e-3)) * std::sin(0.7 * (t + 1e-3));
    const ArmInput input{
        .now = {kTick * i}, .dt = kTick, .tip = tip, .tip_velocity = {(next - tip.x) / 1e-3, 0, 0}};
    const ArmOutput guarded = sut.step(input);
    const ArmOutput plain = bare.step(input);
    ASSERT_EQ(guarded.force, plain.force) << i;
    ASSERT_EQ(guarded.offset, plain.offset);
    ASSERT_EQ(guarded.sample.sequence, plain.sample.sequence);
    if (plain.force.x < 0) ++felt;
  }
  EXPECT_GT(felt, 5000);
  EXPECT_EQ(sut.steps_damped(), 0U);
}

TEST(PassivityGuard, WhatTheHandGaveItGetsBackUpToTheCredit) {
  PassivitySettings settings = uncapped();
  settings.credit_joule = 0.01;
  double newton = -1;
  PassivityGuard sut(std::make_unique<Wisher>([&](const ArmInput& /*input*/) {
                       return Force3{newton, 0, 0};
                     }),
                     settings);
  sut.reset({}, {});
  double x_m = 0;
  const auto go = [&](double force_newton) {
    newton = force_newton;
    const ArmOutput out = sut.step({.dt = kTick, .tip = {x_m, 0, 0}, .tip_velocity = {0.1, 0, 0}});
    x_m += 1e-4;
    return out.force.x;
  };
  for (int i = 0; i < 1000; ++i) go(-1);  // 0.1 J
  EXPECT_NEAR(sut.given_joule(), -0.01, 1e-12);
  double joule = 0;
  for (int i = 0; i < 1000; ++i) joule += 1e-4 * go(1);
  EXPECT_NEAR(joule, settings.credit_joule + settings.bound_joule, 2e-4);
}

TEST(PassivityGuard, PassesOnWhatIsNotFiniteAndResetForgetsTheBalance) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Force3 wish{1, 0, 0};
  auto inside = std::make_unique<Wisher>([&](const ArmInput& /*input*/) { return wish; });
  const Wisher& inner = *inside;
  PassivityGuard sut(std::move(inside), {});
  sut.reset({}, {});
  const auto at = [&](double x_m) {
    return sut.step({.dt = kTick, .tip = {x_m, 0, 0}, .tip_velocity = {0.1, 0, 0}});
  };
  at(0);
  at(0.005);
  EXPECT_NEAR(sut.given_joule(), 0.005, 1e-4);
  wish.x = kNan;
  EXPECT_TRUE(std::isnan(at(0.005).force.x));
  wish.x = 1;
  EXPECT_LT(at(kNan).force.x, 1.1);
  at(0.2);
  EXPECT_LT(sut.given_joule(), 0.006) << "nothing was shown on the way";
  sut.reset({}, {});
  EXPECT_EQ(sut.given_joule(), 0);
  EXPECT_EQ(inner.resets, 2);
}

// A force that is late enough to push the hand along, so that the guard has work.
testing::TurnedTrace feel_guarded(world::World& world, const world::Symmetry& turn) {
  PassivityGuard arm(std::make_unique<RemoteForceArm>(), {});
  RemoteForceWorld far(world, 1);
  LinkedLoop loop(arm, far, kTick, testing::delayed_by(0.03));
  testing::TurnedTrace felt;
  for (int i = 0; i < 12'000; ++i) {
    const ArmOutput out = loop.tick(image(turn, testing::about(1e-3 * i)),
                                    image(turn, testing::about_speed(1e-3 * i)));
    felt.emplace_back(turn, out);
  }
  EXPECT_GT(arm.steps_damped(), 100U) << "the guard is on";
  return felt;
}

TEST(PassivityGuard, MirroredAndPermutedWorldsGiveMirroredAndPermutedForcesThroughIt) {
  testing::FakeBox box(0.015);
  testing::expect_turned_is_felt_turned(box, feel_guarded, 0);
  world::SphereWorld ball = testing::make_ball();
  testing::expect_turned_is_felt_turned(ball, feel_guarded, 1e-6);
}

struct Felt {
  double generated_joule{0};
  double swing_m{0};
  double held_newton{0};
};

// The finger of teleop.md 3 against the wall of a room, 30 mm away.
Felt press(Scheme scheme, double delay_s, const std::optional<PassivitySettings>& guard) {
  world::VoxelWorld room(world::make_box(3).value(), "box:3");
  std::unique_ptr<ArmCoupling> arm = make_arm_coupling(scheme, {});
  if (guard) arm = std::make_unique<PassivityGuard>(std::move(arm), *guard);
  std::unique_ptr<WorldCoupling> world;
  if (has_own_world_half(scheme)) {
    world = make_own_world_half(scheme, {.buffer_zone = {.buffer_m = 0.010}}, room, 1).value();
  } else {
    world = std::make_unique<GhostPointWorld>(room, 1);
  }
  LinkedLoop loop(*arm, *world, kTick, testing::delayed_by(delay_s));
  testing::Reference reference;
  reference.x_m += 0.002;
  Finger finger(reference.x_m);
  for (double t = 0; t < 2 * delay_s + 0.3; t += 1e-3) (void)loop.tick({reference.x_m, 0, 0}, {});
  Felt out;
  double least_m = 1;
  double most_m = -1;
  for (int tick = 0; tick < testing::Reference::kTicks; ++tick) {
    reference.advance(tick);
    const Finger::Sight sight = finger.look();
    const double newton = loop.tick({sight.x_m, 0, 0}, {sight.v_m_per_s, 0, 0}).force.x;
    finger.move(reference.x_m, reference.v_m_per_s, newton);
    if (tick < testing::Reference::kHoldFrom_tick || tick >= testing::Reference::kHoldTo_tick) {
      continue;
    }
    least_m = std::min(least_m, finger.x_m());
    most_m = std::max(most_m, finger.x_m());
    out.held_newton -=
        newton / (testing::Reference::kHoldTo_tick - testing::Reference::kHoldFrom_tick);
  }
  out.swing_m = most_m - least_m;
  out.generated_joule = finger.energy().generated_joule();
  return out;
}

// teleop.md 3, rows "(a) with one-port TDPA": stable up to 50 ms, where it may damp as it needs.
TEST(PassivityGuard, WithoutACapARemoteForceSwingsByMillimetresInsteadOfCentimetres) {
  for (const int delay_ms : {1, 2, 5, 10, 20, 50, 100, 200}) {
    const Felt bare = press(Scheme::RemoteForce, 1e-3 * delay_ms, std::nullopt);
    const Felt felt = press(Scheme::RemoteForce, 1e-3 * delay_ms, uncapped());
    RecordProperty("uncapped_" + std::to_string(delay_ms),
                   std::to_string(1e3 * felt.generated_joule) + " mJ, " +
                       std::to_string(1e3 * felt.swing_m) + " mm, " +
                       std::to_string(felt.held_newton) + " N; bare " +
                       std::to_string(1e3 * bare.swing_m) + " mm");
    EXPECT_LT(felt.swing_m, delay_ms <= 20 ? 0.003 : 0.03) << delay_ms;
    if (delay_ms < 5) continue;
    EXPECT_LT(felt.swing_m, bare.swing_m / 3) << delay_ms;
  }
}

TEST(PassivityGuard, OnEachSchemeTakesEnergyFromTheFingerAndHardlyEverGivesAny) {
  for (const Scheme scheme : kSchemes) {
    for (const int delay_ms : {1, 20, 50, 100, 200, 500}) {
      const Felt bare = press(scheme, 1e-3 * delay_ms, std::nullopt);
      const Felt guarded = press(scheme, 1e-3 * delay_ms, PassivitySettings{});
      const std::string name = std::string(to_string(scheme)) + "_" + std::to_string(delay_ms);
      const auto row = [](const Felt& felt) {
        return std::to_string(1e3 * felt.generated_joule) + " mJ, " +
               std::to_string(1e3 * felt.swing_m) + " mm, " + std::to_string(felt.held_newton) +
               " N";
      };
      RecordProperty(name, row(bare) + "; guarded " + row(guarded));
      EXPECT_LE(guarded.generated_joule, bare.generated_joule + 0.002) << name;
      if (bare.generated_joule < 0.0005) {
        EXPECT_EQ(guarded.held_newton, bare.held_newton) << name;
      }
    }
  }
}

}  // namespace
}  // namespace thimble::coupling
