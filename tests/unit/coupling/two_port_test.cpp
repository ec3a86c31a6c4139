#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "daemon/coupling/remote_force_arm.hpp"
#include "daemon/coupling/remote_force_world.hpp"
#include "daemon/coupling/scheme.hpp"
#include "daemon/coupling/two_port_arm.hpp"
#include "daemon/coupling/two_port_world.hpp"
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

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(PortAccount, LeavesWhatTheOtherEndPutInAndTheBound) {
  PortAccount sut(0.001, 1);
  EXPECT_EQ(sut.left_joule(), 0.001);
  sut.hear(5);
  EXPECT_EQ(sut.left_joule(), 0.001) << "from here on it counts";
  sut.hear(5.25);
  EXPECT_DOUBLE_EQ(sut.left_joule(), 0.251);
  sut.take_out(0.2);
  EXPECT_NEAR(sut.left_joule(), 0.051, 1e-15);
  sut.take_out(0.1);
  EXPECT_EQ(sut.left_joule(), 0);
  sut.hear(5.3);
  EXPECT_NEAR(sut.left_joule(), 0.001, 1e-15) << "what came out too much is missing";
  sut.put_in(0.5);
  sut.put_in(-1);
  EXPECT_EQ(sut.put_in_joule(), 0.5);
}

TEST(PortAccount, WhatCannotBeIsAsGoodAsNone) {
  PortAccount sut(0.001, 1);
  sut.hear(0);
  for (const double told : {kNone, -1.0, 1e10, std::numeric_limits<double>::infinity()}) {
    sut.hear(told);
    EXPECT_EQ(sut.left_joule(), 0.001) << told;
  }
  sut.hear(0.5);
  sut.hear(0.25);
  EXPECT_DOUBLE_EQ(sut.left_joule(), 0.501) << "an older one";
  sut.hear(1e6);
  EXPECT_EQ(sut.left_joule(), 1) << "the credit";
  sut.forget_other_end();
  EXPECT_EQ(sut.left_joule(), 0.001) << "nothing is won by beginning anew";
  sut.hear(1e6);
  EXPECT_EQ(sut.left_joule(), 0.001);
}

// The energies at a port by forces that are held until the next step, added up outside.
struct Oracle {
  double in_joule{0};
  double out_joule{0};
  void add(double work_joule) {
    in_joule += std::max(0.0, -work_joule);
    out_joule += std::max(0.0, work_joule);
  }
};

double any(std::mt19937_64& random, double most) {
  return std::uniform_real_distribution<double>(-most, most)(random);
}

// A world half that pushes as it likes: now a spring that forgets where it was fixed, now anything.
class Whim final : public WorldCoupling {
 public:
  explicit Whim(std::uint64_t seed) : random_(seed) {}
  Result<void> open(const HandSample& first) override {
    at_ = first.hand;
    told_ = {};
    set_.answers = 0;
    ++set_.session;
    return {};
  }
  ConstraintSet answer(const HandSample& sample, Duration /*dt*/) noexcept override {
    if (sample.sequence <= set_.answers) return set_;
    port.add(-dot(told_, sample.hand - at_));
    at_ = sample.hand;
    if (random_() % 40 == 0) anchor_ = {any(random_, 0.03), any(random_, 0.03), 0};
    if (random_() % 200 == 0) newton_per_m_ = 400 + any(random_, 400);
    const Displacement3 spring = anchor_ - at_;
    told_ = {newton_per_m_ * spring.x, newton_per_m_ * spring.y, any(random_, 2)};
    ++set_.sequence;
    set_.answers = sample.sequence;
    set_.sampled_at = sample.sampled_at;
    set_.has_far = true;
    set_.far.force = told_;
    return set_;
  }
  void close() noexcept override {}

  Oracle port;

 private:
  std::mt19937_64 random_;
  Position3 at_{};
  Position3 anchor_{};
  double newton_per_m_{400};
  Force3 told_{};
  ConstraintSet set_{};
};

struct Channel {
  link::ImpairmentSettings settings;
  int least_way_ticks;  // one way
};

std::vector<Channel> channels() {
  return {{{.delay_s = 0}, 0},
          {{.delay_s = 0.04}, 20},
          {{.delay_s = 0.2}, 100},
          {{.delay_s = 0.04, .jitter_s = 0.02}, 5},
          {{.delay_s = 0.04, .loss = 0.2}, 20},
          {{.delay_s = 0.04, .jitter_s = 0.02, .loss = 0.1, .duplicate = 0.1, .reorder = 0.3}, 0}};
}

// At every sample, at both ends, whatever the world wishes and the channel does.
TEST(TwoPort, NoMoreComesOutAtEitherEndThanWasPutInAtTheOtherOneWayAgo) {
  const PassivitySettings exact{.least_m_per_s = 0};  // the hand's velocity tells its next move
  for (std::size_t c = 0; c < channels().size(); ++c) {
    const Channel channel = channels()[c];
    std::mt19937_64 random(456 + c);
    TwoPortArm arm(std::make_unique<RemoteForceArm>(), exact);
    auto whim = std::make_unique<Whim>(c);
    const Oracle& world = whim->port;
    TwoPortWorld far(std::move(whim), exact);
    LinkedLoop loop(arm, far, kTick, channel.settings);
    Oracle hand;
    // A ring: each entry is so old when it is written over.
    std::vector<Oracle> past_hand(static_cast<std::size_t>(std::max(1, channel.least_way_ticks)));
    std::vector<Oracle> past_world = past_hand;
    Position3 tip{};
    Velocity3 velocity{};
    for (std::size_t i = 0; i < 4000; ++i) {
      const Force3 force = loop.tick(tip, velocity).force;
      const Displacement3 moved{1e-3 * velocity.x, 1e-3 * velocity.y, 1e-3 * velocity.z};
      tip = tip + moved;
      const std::size_t ago = i % past_hand.size();
      ASSERT_LE(world.out_joule, past_hand[ago].in_joule + exact.bound_joule + 1e-9)
          << c << ' ' << i;
      hand.add(dot(force, moved));
      ASSERT_LE(hand.out_joule, past_world[ago].in_joule + exact.bound_joule + 1e-9)
          << c << ' ' << i;
      past_hand[ago] = hand;
      past_world[ago] = world;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        velocity[axis] += any(random, 0.05) - 1e-3 * (250 * tip[axis] + 20 * velocity[axis]);
      }
    }
    EXPECT_GT(hand.in_joule, 0.01) << c;
    EXPECT_GT(hand.out_joule, 0.002) << c << ": not all is withheld";
    EXPECT_GT(arm.steps_withheld(), 10U) << c;
  }
}

// An arm half that wishes a force of its own, whatever is said.
class Wishing final : public ArmCoupling {
 public:
  explicit Wishing(std::function<Force3(const ArmInput&)> wish) : wish_(std::move(wish)) {}

 private:
  void restart(MonotonicTime /*now*/, Position3 /*tip*/) noexcept override {}
  ArmOutput advance(const ArmInput& input) noexcept override {
    ArmOutput out;
    out.force = wish_(input);
    return out;
  }
  std::function<Force3(const ArmInput&)> wish_;
};

TEST(TwoPort, WhateverAWorldTellsTheHandIsGivenNoMoreThanByTheBareScheme) {
  std::mt19937_64 random(457);
  const auto hostile = [&] {
    constexpr double kAny[] = {
        kNone, -1, 1e300, -1e300, 1e8, 0, std::numeric_limits<double>::infinity()};
    const std::size_t n = random() % 10;
    return n < std::size(kAny) ? kAny[n] : any(random, 0.1);
  };
  Force3 wish{};
  TwoPortArm sut(std::make_unique<Wishing>([&](const ArmInput& /*input*/) { return wish; }), {});
  ConstraintSet said;
  for (int i = 0; i < 20000; ++i) {
    if (random() % 20 == 0) said.session = static_cast<std::uint32_t>(random() % 3);
    said.energy_joule = hostile();
    wish = {any(random, 8), any(random, 8), random() % 50 == 0 ? kNone : any(random, 8)};
    const Position3 tip{random() % 70 == 0 ? kNone : any(random, 0.1), any(random, 0.1), 0};
    const Velocity3 v{any(random, 0.5), random() % 90 == 0 ? kNone : any(random, 0.5), 0};
    const ArmOutput out = sut.step({.dt = kTick, .tip = tip, .tip_velocity = v, .fresh = &said});
    ASSERT_TRUE(std::isfinite(out.sample.energy_joule) && out.sample.energy_joule >= 0);
    if (!is_finite(wish)) {
      ASSERT_FALSE(is_finite(out.force)) << "that the limiter latches it";
      continue;
    }
    if (!is_finite(v)) continue;
    const double bare_watt = dot(wish, v);
    const double felt_watt = dot(out.force, v);
    ASSERT_LE(felt_watt, std::max(bare_watt, 0.0) + 1e-9);
    ASSERT_GE(felt_watt, std::min(bare_watt, 0.0) - 1e-9) << "and none is turned round";
  }
}

TEST(TwoPort, AnArmWhoseHandIsNeverPushedIsNotChangedByABit) {
  const auto drag = [](const ArmInput& input) { return Damping{-5} * input.tip_velocity; };
  TwoPortArm sut(std::make_unique<Wishing>(drag), {});
  Wishing bare(drag);
  std::mt19937_64 random(458);
  for (int i = 0; i < 1000; ++i) {
    const ArmInput input{.dt = kTick, .tip_velocity = {any(random, 1), any(random, 1), 0}};
    ASSERT_EQ(sut.step(input).force, bare.step(input).force);
  }
  EXPECT_EQ(sut.steps_withheld(), 0U);
}

TEST(TwoPortWorld, AnArmThatTellsNoEnergyIsAnsweredAsWithoutTheGuard) {
  world::VoxelWorld room(world::make_box(3).value(), "box:3");
  RemoteForceWorld bare(room, 1);
  TwoPortWorld sut(std::make_unique<RemoteForceWorld>(room, 1));
  ASSERT_TRUE(bare.open({}) && sut.open({}));
  for (std::uint64_t i = 1; i < 100; ++i) {
    HandSample sample = testing::sample(i, {2e-4 * static_cast<double>(i), 0, 0});
    sample.tool = {{800}, {0}};
    const Force3 expected = bare.answer(sample, kTick).far.force;
    EXPECT_EQ(sut.answer(sample, kTick).far.force, expected);
    EXPECT_EQ(expected.x<-0.5, i> 78) << i;
  }
}

TEST(TwoPortWorld, AHandGoesOnIntoAWallAsFarAsItsEnergyGoes) {
  for (const double told_joule : {0.0, 0.01, kNone, 1e300}) {
    world::VoxelWorld room(world::make_box(3).value(), "box:3");
    TwoPortWorld sut(std::make_unique<RemoteForceWorld>(room, 1));
    HandSample sample = testing::sample(1, {});
    sample.tool = {{800}, {0}};
    sample.energy_joule = 0;
    ASSERT_TRUE(sut.open(sample));
    for (std::uint64_t i = 1; i < 400; ++i) {
      sample.sequence = i;
      sample.energy_joule = i == 1 ? 0 : told_joule;
      sample.hand.x = std::min(0.030, 2e-4 * static_cast<double>(i));
      (void)sut.answer(sample, kTick);
    }
    // ½·K·x² = what was told and the bound; a NaN is no guard's, and of an absurd one nothing is.
    const double left_joule = 0.001 + (told_joule > 0 && told_joule < 1 ? told_joule : 0);
    const double expected_m = std::isnan(told_joule) ? 0.015 : std::sqrt(2 * left_joule / 800);
    EXPECT_NEAR(sut.place().x - 0.015, expected_m, 0.0002) << told_joule;
    sample.hand.x = 0;
    ++sample.sequence;
    (void)sut.answer(sample, kTick);
    EXPECT_EQ(sut.place().x, 0) << "at once in free space";
  }
}

testing::TurnedTrace feel_guarded(world::World& world, const world::Symmetry& turn) {
  TwoPortArm arm(std::make_unique<RemoteForceArm>(), {});
  TwoPortWorld far(std::make_unique<RemoteForceWorld>(world, 1));
  LinkedLoop loop(arm, far, kTick, testing::delayed_by(0.03));
  testing::TurnedTrace felt;
  int held_back = 0;  // steps in which the world does not take the hand where it goes
  for (int i = 0; i < 12'000; ++i) {
    const Position3 tip = image(turn, testing::about(1e-3 * i));
    const ArmOutput out = loop.tick(tip, image(turn, testing::about_speed(1e-3 * i)));
    felt.emplace_back(turn, out);
    if (norm(far.place() - tip) > 0.005) ++held_back;
  }
  EXPECT_GT(arm.steps_withheld(), 100U) << "the arm's end is at work";
  EXPECT_GT(held_back, 100) << "and the world's";
  return felt;
}

TEST(TwoPort, MirroredAndPermutedWorldsGiveMirroredAndPermutedForcesThroughIt) {
  testing::FakeBox box(0.015);
  testing::expect_turned_is_felt_turned(box, feel_guarded, 1e-6);
  world::SphereWorld ball = testing::make_ball();
  testing::expect_turned_is_felt_turned(ball, feel_guarded, 1e-6);
}

struct Course {
  double generated_joule{0};
  double swing_m{0};
  double held_newton{0};
};

enum class Guard { None, One, Two };

// The finger of teleop.md 3 against a wall of the box, which it leans on for 2 s and leaves.
Course press(Scheme scheme, double delay_s, Guard guard) {
  world::VoxelWorld room(world::make_box(3).value(), "box:3");
  std::unique_ptr<ArmCoupling> arm = make_arm_coupling(scheme, {});
  if (guard == Guard::One)
    arm = std::make_unique<PassivityGuard>(std::move(arm), PassivitySettings{});
  if (guard == Guard::Two) arm = std::make_unique<TwoPortArm>(std::move(arm), PassivitySettings{});
  const std::unique_ptr<WorldCoupling> world = make_own_world_half(scheme, {}, room, 1).value();
  LinkedLoop loop(*arm, *world, kTick, testing::delayed_by(delay_s));
  testing::Reference reference;
  Finger finger(reference.x_m);
  for (double t = 0; t < 2 * delay_s + 0.3; t += 1e-3) (void)loop.tick({reference.x_m, 0, 0}, {});
  Course out;
  double least_m = 1;
  double most_m = -1;
  for (int tick = 0; tick < testing::Reference::kTicks; ++tick) {
    reference.advance(tick);
    const Finger::Sight sight = finger.look();
    const double newton = loop.tick({sight.x_m, 0, 0}, {sight.v_m_per_s, 0, 0}).force.x;
    finger.move(reference.x_m, reference.v_m_per_s, newton);
    if (tick < 3500 || tick >= testing::Reference::kHoldTo_tick) continue;
    least_m = std::min(least_m, finger.x_m());
    most_m = std::max(most_m, finger.x_m());
    out.held_newton -= newton / (testing::Reference::kHoldTo_tick - 3500);
  }
  out.swing_m = most_m - least_m;
  out.generated_joule = finger.energy().generated_joule();
  return out;
}

TEST(TwoPort, AFingerOnARemoteForceThatSwingsIsHeldAndOneOnASpringDamperNotChanged) {
  for (const Scheme scheme : {Scheme::RemoteForce, Scheme::SpringDamper}) {
    for (const int delay_ms : {1, 5, 20, 50, 100, 200, 500}) {
      const Course bare = press(scheme, 1e-3 * delay_ms, Guard::None);
      const Course one = press(scheme, 1e-3 * delay_ms, Guard::One);
      const Course two = press(scheme, 1e-3 * delay_ms, Guard::Two);
      const auto row = [](const Course& of) {
        return std::to_string(1e3 * of.generated_joule) + " mJ, " +
               std::to_string(1e3 * of.swing_m) + " mm, " + std::to_string(of.held_newton) + " N";
      };
      const std::string name = std::string(to_string(scheme)) + "_" + std::to_string(delay_ms);
      RecordProperty(name, row(bare) + "; one " + row(one) + "; two " + row(two));
      if (scheme == Scheme::SpringDamper) {  // is passive
        EXPECT_NEAR(two.held_newton, bare.held_newton, 1e-6) << name;
        EXPECT_NEAR(two.swing_m, bare.swing_m, 1e-8) << name;
        continue;
      }
      EXPECT_LT(two.swing_m, 0.03) << name;
      EXPECT_GT(two.held_newton, 2) << name;
      if (delay_ms < 5) continue;
      EXPECT_LT(two.swing_m, bare.swing_m / 4) << name;
      EXPECT_LT(two.generated_joule, bare.generated_joule / 50) << name;
    }
  }
}

}  // namespace
}  // namespace thimble::coupling
