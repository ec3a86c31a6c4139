#include "daemon/coupling/thesis_literal.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <random>

#include "thesis_callback_oracle.hpp"

namespace thimble::coupling {
namespace {

namespace oracle = thesis_callback_oracle;
using Floats = std::array<float, 3>;

std::array<std::uint32_t, 3> bits(const Floats& f) {
  return {std::bit_cast<std::uint32_t>(f[0]), std::bit_cast<std::uint32_t>(f[1]),
          std::bit_cast<std::uint32_t>(f[2])};
}
std::array<std::uint32_t, 3> bits(const float* f) { return bits(Floats{f[0], f[1], f[2]}); }

struct Recorded {
  Floats position_mm;
  Floats velocity_mm_per_s;
  ThesisConstraint constraint;
};

// A recording in the form of its seed: a hand that wanders through the range of the arm, with
// constraints that come, stay, move and go as a slow world's would; now and then a value lies
// exactly on an edge, both bits of an axis are set, or an unused value is garbage.
class Recording {
 public:
  explicit Recording(std::uint32_t seed) : random_(seed) {}

  Recorded next() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      float& v = now_.velocity_mm_per_s[axis];
      float& p = now_.position_mm[axis];
      v = 0.98F * v + uniform(-40, 40);
      p += v / 1000;
      if (p > 63.5F || p < -63.5F) v = -v;
    }
    if (chance(12)) change_constraint();
    if (chance(50)) put_on_edge();
    return now_;
  }

 private:
  void change_constraint() {
    const std::size_t axis = random_() % 3;
    const unsigned mask = 3U << (2 * axis);
    const unsigned bit = chance(40) ? 3U : static_cast<unsigned>(random_() % 3);
    const unsigned rest = now_.constraint.directions & ~mask;
    now_.constraint.directions = static_cast<std::uint8_t>(rest | (bit << (2 * axis)));
    constexpr std::array<float, 4> kFaces{-45, -15, 15, 45};
    float plane = chance(3) ? kFaces[random_() % 4] : now_.position_mm[axis] + uniform(-30, 30);
    if (bit == 0 && chance(2)) {
      constexpr std::array kGarbage{std::numeric_limits<float>::quiet_NaN(),
                                    std::numeric_limits<float>::infinity(), -3e38F, 1e-42F};
      plane = kGarbage[random_() % 4];
    }
    now_.constraint.plane_mm[axis] = plane;
  }
  // Exactly H past the plane, or exactly on it: the comparisons must have the printed sense.
  void put_on_edge() {
    const std::size_t axis = random_() % 3;
    if (((unsigned{now_.constraint.directions} >> (2 * axis)) & 3U) == 0) return;
    constexpr std::array<float, 3> kSteps{-0.5F, 0, 0.5F};
    now_.position_mm[axis] = now_.constraint.plane_mm[axis] + kSteps[random_() % 3];
  }
  bool chance(unsigned one_in) { return random_() % one_in == 0; }
  float uniform(float low, float high) {
    return low + (high - low) * static_cast<float>(random_() >> 8) / 16777216.0F;
  }

  std::mt19937 random_;
  Recorded now_{};
};

TEST(ThesisLiteralServo, EqualsThePrintedCallbackBitForBit) {
  for (const std::uint32_t seed : {1999U, 5001U, 8U}) {
    Recording recording(seed);
    ThesisLiteralServo sut;
    oracle::restart();
    int forces = 0;
    int offsets = 0;
    for (int i = 0; i < 10'000; ++i) {
      Recorded in = recording.next();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        oracle::constraint[axis] = in.constraint.plane_mm[axis];
      }
      oracle::constdir = in.constraint.directions;
      std::array<float, 3> force{};
      oracle::callback(in.position_mm.data(), in.velocity_mm_per_s.data(), force.data());
      const ThesisTick tick = sut.step(in.position_mm, in.velocity_mm_per_s, in.constraint);
      ASSERT_EQ(bits(tick.force_newton), bits(force)) << "seed " << seed << " tick " << i;
      ASSERT_EQ(bits(tick.adjusted_mm), bits(oracle::adjpos)) << "seed " << seed << " tick " << i;
      ASSERT_EQ(bits(tick.offset_mm), bits(oracle::offset)) << "seed " << seed << " tick " << i;
      forces += force != std::array<float, 3>{} ? 1 : 0;
      offsets += tick.offset_mm != Floats{} ? 1 : 0;
    }
    EXPECT_GT(forces, 1000) << "the recording must touch";
    EXPECT_GT(offsets, 1000) << "the recording must shift the frame";
  }
}

ThesisTick touch(ThesisLiteralServo& sut, float x_mm, ThesisConstraint constraint) {
  ThesisConstraint erased = constraint;
  sut.step({}, {}, erased);
  return sut.step({x_mm, 0, 0}, {}, constraint);
}

TEST(ThesisLiteralServo, LeavesTheFingerInsideTheWallTowardsPlus) {
  ThesisLiteralServo sut;
  const ThesisTick tick = touch(sut, 20, {{15, 0, 0}, 0x01});
  EXPECT_EQ(tick.adjusted_mm[0], 15.5F);
  EXPECT_LT(tick.force_newton[0], 0);
}

// Defect 1, kept on purpose.
TEST(ThesisLiteralServo, LeavesTheFingerOutsideTheWallTowardsMinus) {
  ThesisLiteralServo sut;
  const ThesisTick tick = touch(sut, -20, {{-15, 0, 0}, 0x02});
  EXPECT_EQ(tick.adjusted_mm[0], -14.5F);
  EXPECT_EQ(tick.force_newton[0], 0);
}

TEST(ThesisLiteralServo, ErasesTheConstraintInItsFirstTick) {
  ThesisLiteralServo sut;
  ThesisConstraint constraint{{15, 0, 0}, 0x01};
  EXPECT_EQ(sut.step({20, 0, 0}, {}, constraint).force_newton, Floats{});
  EXPECT_EQ(constraint.directions, 0);
}

ArmOutput told(ThesisLiteralArm& sut, int tick, Position3 tip, const ConstraintSet* fresh) {
  ArmInput input{.now = {std::chrono::milliseconds(tick)}, .dt = std::chrono::milliseconds(1)};
  input.tip = tip;
  input.fresh = fresh;
  return sut.step(input);
}

TEST(ThesisLiteralArm, SpeaksSiUnitsAndPlanesWithNormals) {
  ThesisLiteralArm sut;
  sut.reset({}, {});
  ConstraintSet set;
  set.sequence = 4;
  set.planes.push_back({.normal = {0, 0, -1}, .offset_m = 0.015, .surface = {}});
  set.planes.push_back({.normal = {0.6, 0.8, 0}, .offset_m = -1, .surface = {}});
  told(sut, 1, {}, nullptr);
  const ArmOutput first = told(sut, 2, {0, 0, -0.0153}, &set);
  EXPECT_NEAR(first.force.z, 0.24, 1e-5);
  EXPECT_EQ(first.force.x, 0);
  EXPECT_EQ(first.new_contacts, 1U);
  EXPECT_TRUE(first.is_in_contact);
  EXPECT_EQ(first.sample.applied_reply, 4U);
  EXPECT_EQ(first.sample.sequence, 2U);
  EXPECT_NEAR(first.sample.hand.z, -0.0153, 1e-8);
  EXPECT_EQ(told(sut, 3, {0, 0, -0.0153}, &set).new_contacts, 0U);
}

TEST(ThesisLiteralArm, ReportsTheOffsetInMetres) {
  ThesisLiteralArm sut;
  sut.reset({}, {});
  ConstraintSet set;
  set.planes.push_back({.normal = {1, 0, 0}, .offset_m = 0.015, .surface = {}});
  told(sut, 1, {}, nullptr);
  EXPECT_NEAR(told(sut, 2, {0.020, 0, 0}, &set).offset.x, -0.0045, 1e-8);
}

TEST(ThesisLiteralArm, APlaneThatIsNowhereMovesNoFrame) {
  for (const double offset_m :
       {std::numeric_limits<double>::max(), 1e37, 2e6, std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN()}) {
    for (const double side : {-1.0, 1.0}) {
      ThesisLiteralArm sut;
      sut.reset({}, {});
      ConstraintSet set;
      set.planes.push_back({.normal = {side, 0, 0}, .offset_m = -offset_m, .surface = {}});
      told(sut, 1, {}, nullptr);
      const ArmOutput out = told(sut, 2, {0.01, 0, 0}, &set);
      EXPECT_EQ(out.offset, Displacement3{}) << offset_m;
      EXPECT_EQ(out.force, Force3{}) << offset_m;
    }
  }
}

TEST(ThesisLiteralArm, StillLosesForceWhenTheWorldFallsSilent) {
  ThesisLiteralArm sut;
  sut.reset({}, {});
  ConstraintSet set;
  set.planes.push_back({.normal = {1, 0, 0}, .offset_m = 0.015, .surface = {}});
  told(sut, 1, {}, nullptr);
  EXPECT_LT(told(sut, 2, {0.0153, 0, 0}, &set).force.x, -0.2);
  ArmOutput out{};
  for (int i = 3; i < 400; ++i) out = told(sut, i, {0.0153, 0, 0}, nullptr);
  EXPECT_EQ(out.force, Force3{});
  EXPECT_TRUE(out.is_fading);
}

TEST(ThesisLiteralArm, ResetForgetsFrameAndWalls) {
  ThesisLiteralArm sut;
  sut.reset({}, {});
  ConstraintSet set;
  set.planes.push_back({.normal = {1, 0, 0}, .offset_m = 0.015, .surface = {}});
  told(sut, 1, {}, nullptr);
  told(sut, 2, {0.020, 0, 0}, &set);
  sut.reset({std::chrono::milliseconds(2)}, {0.020, 0, 0});
  const ArmOutput out = told(sut, 3, {0.020, 0, 0}, nullptr);
  EXPECT_EQ(out.force, Force3{});
  EXPECT_EQ(out.offset, Displacement3{});
}

TEST(ThesisLiteralArm, EverySampleSaysHowOftenItWasReset) {
  ThesisLiteralArm sut;
  for (std::uint32_t resets = 1; resets <= 3; ++resets) {
    sut.reset({}, {});
    EXPECT_EQ(told(sut, 1, {}, nullptr).sample.restart, resets);
    EXPECT_EQ(told(sut, 2, {}, nullptr).sample.restart, resets);
  }
}

}  // namespace
}  // namespace thimble::coupling
