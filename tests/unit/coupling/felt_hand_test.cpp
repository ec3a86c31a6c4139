#include "daemon/coupling/felt_hand.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>

#include "daemon/coupling/buffer_zone_arm.hpp"
#include "daemon/coupling/buffer_zone_world.hpp"
#include "daemon/coupling/composite_arm.hpp"
#include "daemon/coupling/composite_world.hpp"
#include "daemon/coupling/constraint_plane_arm.hpp"
#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/coupling/remote_force_arm.hpp"
#include "daemon/coupling/remote_force_world.hpp"
#include "daemon/coupling/spring_damper_arm.hpp"
#include "daemon/coupling/spring_damper_world.hpp"
#include "daemon/coupling/thesis_literal.hpp"
#include "daemon/coupling/wave_arm.hpp"
#include "daemon/coupling/wave_world.hpp"
#include "daemon/world/voxel_world.hpp"
#include "delayed_loop.hpp"

namespace thimble::coupling {
namespace {

using testing::DelayedLoop;
using testing::Pace;

constexpr Duration kEyeStep = std::chrono::milliseconds(1);
constexpr double kBoxWall_m = 0.015;                   // of the box of the thesis
constexpr double kEyeSpeed_m_per_s = 0.0973718281828;  // meets the wall between two ticks
// Between what is shown as touching and as not.
constexpr double kEyeFrame_m_per_s = 0.02493;  // likewise, on its way back
constexpr double kEyeTouch_m = 1e-9;

enum class Way {
  GhostPoint,
  LockStep,
  ConstraintPlane,
  BufferZoneCells,
  BufferZoneFaces,
  Remote,
  Composite,
  SpringDamper,
  SpringDamperBoth,
  Wave,
  ThesisLiteral
};

// A hand that goes to and fro in the box: towards a wall until it is felt, leans, and goes back.
class Eye {
 public:
  Eye(Way way, Duration delay)
      : way_(way),
        delay_(delay),
        box_(std::make_unique<world::VoxelWorld>(world::make_box(3).value(), "box:3")) {
    const Pace pace = way == Way::LockStep ? Pace::LockStep : Pace::Streamed;
    arm_ = make_arm();
    loop_.emplace(*arm_, make_world(), kEyeStep, delay, pace);
    for (Duration t{}; t < 2 * delay; t += kEyeStep) tick(0);
  }

  void poke(double sign) {
    for (int i = 0; !out_.is_in_contact && i < 4000; ++i) tick(sign * kEyeSpeed_m_per_s);
    EXPECT_TRUE(out_.is_in_contact);
    for (int i = 0; i < 30; ++i) tick(sign * kEyeSpeed_m_per_s / 5);  // leans on it
    for (int i = 0; i < 20; ++i) tick(0);
    while (sign * tip_m_ > 0) tick(-sign * kEyeSpeed_m_per_s);
    // A frame that is on its way back would add its speed to the hand's.
    for (int i = 0; i < 8000 && norm(out_.offset) > 0; ++i) tick(0);
    for (Duration t{}; t < 3 * delay_; t += kEyeStep) tick(0);
  }

  [[nodiscard]] int felt() const { return felt_; }
  [[nodiscard]] int differing() const { return differing_; }
  [[nodiscard]] int behind() const { return behind_; }
  [[nodiscard]] double largest_jump_m() const { return largest_jump_m_; }
  [[nodiscard]] Duration shortest_lag() const { return shortest_lag_; }
  [[nodiscard]] Duration longest_lag() const { return longest_lag_; }

 private:
  std::unique_ptr<ArmCoupling> make_arm() const {
    switch (way_) {
      case Way::ConstraintPlane:
        return std::make_unique<ConstraintPlaneArm>(
            ConstraintPlaneSettings{.relaxation_m_per_s = kEyeFrame_m_per_s});
      case Way::BufferZoneCells:
      case Way::BufferZoneFaces:
        return std::make_unique<BufferZoneArm>();
      case Way::Remote:
        return std::make_unique<RemoteForceArm>();
      case Way::Composite:
        return std::make_unique<CompositeArm>(GhostPointSettings{.cell_m = 0.03});
      case Way::SpringDamper:
        return std::make_unique<SpringDamperArm>();
      case Way::SpringDamperBoth:
        return std::make_unique<SpringDamperArm>(SpringDamperSettings{.force_at = ForceAt::Both});
      case Way::Wave:
        return std::make_unique<WaveArm>();
      case Way::ThesisLiteral:
        return std::make_unique<ThesisLiteralArm>();
      case Way::GhostPoint:
      case Way::LockStep:
        break;
    }
    return std::make_unique<GhostPointArm>(
        GhostPointSettings{.cell_m = 0.03, .relaxation_m_per_s = kEyeFrame_m_per_s});
  }
  std::unique_ptr<WorldCoupling> make_world() {
    if (way_ == Way::Composite) return std::make_unique<CompositeWorld>(*box_, 1);
    if (way_ == Way::Remote) return std::make_unique<RemoteForceWorld>(*box_, 1);
    if (way_ == Way::SpringDamper) return std::make_unique<SpringDamperWorld>(*box_, 1);
    if (way_ == Way::SpringDamperBoth) {
      return std::make_unique<SpringDamperWorld>(*box_, 1, ForceAt::Both);
    }
    if (way_ == Way::Wave) return std::make_unique<WaveWorld>(*box_, 1);
    if (way_ != Way::BufferZoneCells && way_ != Way::BufferZoneFaces) {
      return std::make_unique<GhostPointWorld>(*box_, 1);
    }
    const ZoneNames names = way_ == Way::BufferZoneCells ? ZoneNames::Cells : ZoneNames::Faces;
    return std::make_unique<BufferZoneWorld>(
        *box_, 1, BufferZoneWorldSettings{.buffer_m = 0.08, .names = names});
  }

  void tick(double speed_m_per_s) {
    tip_m_ += seconds(kEyeStep) * speed_m_per_s;
    out_ = loop_->tick({tip_m_, 0, 0}, {speed_m_per_s, 0, 0});
    const FeltHand& shown = loop_->felt();
    const double room_m = kBoxWall_m - std::abs(shown.hand.x);
    if (out_.is_in_contact) ++felt_;
    if ((room_m < kEyeTouch_m) != out_.is_in_contact) ++differing_;
    if (room_m < -1e-12) ++behind_;
    // Before the first answer nothing is known of where it was answered.
    if (++ticks_ < 2 * (delay_ / kEyeStep + 1)) {
      last_shown_m_ = shown.hand.x;
      return;
    }
    largest_jump_m_ = std::max(largest_jump_m_, std::abs(shown.hand.x - last_shown_m_));
    last_shown_m_ = shown.hand.x;
    shortest_lag_ = std::min(shortest_lag_, shown.lag);
    longest_lag_ = std::max(longest_lag_, shown.lag);
  }

  Way way_;
  Duration delay_;
  std::unique_ptr<world::VoxelWorld> box_;
  std::unique_ptr<ArmCoupling> arm_;
  std::optional<DelayedLoop> loop_;
  ArmOutput out_{};
  double tip_m_{0};
  double last_shown_m_{0};
  double largest_jump_m_{0};
  int ticks_{0};
  int felt_{0};
  int differing_{0};
  int behind_{0};
  Duration shortest_lag_{std::chrono::hours(1)};
  Duration longest_lag_{};
};

const char* name_of(Way way) {
  switch (way) {
    case Way::GhostPoint:
      return "GhostPoint";
    case Way::LockStep:
      return "LockStep";
    case Way::ConstraintPlane:
      return "ConstraintPlane";
    case Way::BufferZoneCells:
      return "BufferZoneCells";
    case Way::BufferZoneFaces:
      return "BufferZoneFaces";
    case Way::Composite:
      return "Composite";
    case Way::SpringDamper:
      return "SpringDamper";
    case Way::SpringDamperBoth:
      return "SpringDamperBothEnds";
    case Way::Wave:
      return "Wave";
    case Way::ThesisLiteral:
      return "ThesisLiteral";
    case Way::Remote:
      break;
  }
  return "RemoteForce";
}

class FeltAtEveryDelay : public ::testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(, FeltAtEveryDelay,
                         ::testing::Values(Way::GhostPoint, Way::LockStep, Way::ConstraintPlane,
                                           Way::BufferZoneCells, Way::BufferZoneFaces, Way::Remote,
                                           Way::Composite, Way::SpringDamper, Way::SpringDamperBoth,
                                           Way::Wave, Way::ThesisLiteral),
                         [](const auto& of) { return std::string(name_of(of.param)); });

TEST_P(FeltAtEveryDelay, WhatTouchesInThePictureIsFeltAndWhatIsFeltTouches) {
  const bool is_printed = GetParam() == Way::ThesisLiteral;
  const bool is_slow = is_printed || GetParam() == Way::SpringDamper ||
                       GetParam() == Way::SpringDamperBoth || GetParam() == Way::Wave;
  for (int ms = 1; ms <= 500; ms += is_slow ? std::max(1, ms / 4) : 1) {
    Eye eye(GetParam(), std::chrono::milliseconds(ms));
    eye.poke(1);
    eye.poke(-1);
    // As printed, a finger on three of the six faces is put outside again and again (defect 1).
    EXPECT_GT(eye.felt(), is_printed ? 30 : 80) << ms;
    // Its offset is set, in binary32 of mm, in the tick that a wall comes or goes.
    EXPECT_LE(eye.differing(), is_printed ? 2 : 0) << ms;
    EXPECT_LE(eye.behind(), is_printed ? 2 : 0) << ms;
    if (HasFailure()) return;
  }
}

TEST_P(FeltAtEveryDelay, TheHandIsShownOneRoundTripEarlierInTheOpen) {
  for (const int ms : {1, 20, 100, 500}) {
    const Duration delay = std::chrono::milliseconds(ms);
    Eye eye(GetParam(), delay);
    eye.poke(1);
    const bool is_foretold = GetParam() == Way::BufferZoneCells ||
                             GetParam() == Way::BufferZoneFaces || GetParam() == Way::Composite;
    if (is_foretold) {
      EXPECT_EQ(eye.longest_lag(), Duration{}) << "its walls are foretold: it is felt at once";
    } else {
      EXPECT_GE(eye.shortest_lag(), delay) << ms;
      EXPECT_LE(eye.longest_lag(), GetParam() == Way::LockStep ? 2 * delay + kEyeStep : delay)
          << ms;
    }
  }
}

// In lock-step a place is told once a round trip.
class FeltWhileStreamed : public ::testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(, FeltWhileStreamed,
                         ::testing::Values(Way::GhostPoint, Way::ConstraintPlane,
                                           Way::BufferZoneCells, Way::BufferZoneFaces, Way::Remote,
                                           Way::Composite),
                         [](const auto& of) { return std::string(name_of(of.param)); });

TEST_P(FeltWhileStreamed, TheHandIsNeverSeenToJump) {
  for (const int ms : {1, 20, 100, 500}) {
    Eye eye(GetParam(), std::chrono::milliseconds(ms));
    eye.poke(1);
    eye.poke(-1);
    // A step of the hand, one of the frame, and the clearance of what is not felt.
    EXPECT_LT(eye.largest_jump_m(),
              2e-3 * kEyeSpeed_m_per_s + 0.025e-3 + FeltHandObserver::kClear_m)
        << ms;
  }
}

struct Shown {
  FeltHandObserver observer;
  MonotonicTime now{};

  const FeltHand& step(Position3 tip, const ConstraintSet* fresh, bool is_in_contact = false,
                       bool is_fading = false) {
    now = now + kEyeStep;
    const ArmInput input{.now = now, .dt = kEyeStep, .tip = tip, .fresh = fresh};
    ArmOutput output;
    output.is_in_contact = is_in_contact;
    output.is_fading = is_fading;
    observer.observe(input, output);
    return observer.felt();
  }
};

ConstraintSet late_wall(double offset_m, MonotonicTime sampled_at) {
  ConstraintSet set{.sequence = 1, .sampled_at = sampled_at};
  set.planes.push_back({.normal = {1, 0, 0}, .offset_m = offset_m});
  return set;
}

TEST(FeltHand, ATapThatIsNotFeltIsNotSeenToTouch) {
  Shown sut;
  for (const double x_m : {0.0, 0.01, 0.02, 0.01, 0.0}) (void)sut.step({x_m, 0, 0}, nullptr);
  const ConstraintSet late = late_wall(0.015, MonotonicTime{} + 3 * kEyeStep);
  const FeltHand& shown = sut.step({}, &late);
  EXPECT_DOUBLE_EQ(shown.hand.x, 0.015 - FeltHandObserver::kClear_m);
  EXPECT_EQ(shown.lag, 3 * kEyeStep);
}

TEST(FeltHand, AHandWhoseWorldIsSilentIsShownWhereItIs) {
  Shown sut;
  const ConstraintSet set = late_wall(0.015, MonotonicTime{} + kEyeStep);
  (void)sut.step({0.001, 0, 0}, nullptr);
  (void)sut.step({0.002, 0, 0}, &set);
  const FeltHand& shown = sut.step({0.03, 0, 0}, nullptr, false, true);
  EXPECT_EQ(shown.hand, (Position3{0.03, 0, 0}));
  EXPECT_TRUE(shown.planes.empty());
  EXPECT_FALSE(shown.has_ghost);
}

TEST(FeltHand, ShowsThePressureOfTheNewestAnswerUntilTheWorldIsSilent) {
  Shown sut;
  ConstraintSet set = late_wall(0.015, MonotonicTime{} + kEyeStep);
  EXPECT_FALSE(sut.step({}, &set).has_pressure);
  set.has_pressure = true;
  set.pressure = {-1.5, 0, 0.25};
  ASSERT_TRUE(sut.step({0.02, 0, 0}, &set, true).has_pressure);
  const FeltHand& shown = sut.step({0.03, 0, 0}, nullptr, true);
  EXPECT_EQ(shown.pressure, (Force3{-1.5, 0, 0.25})) << "of the newest answer";
  EXPECT_FALSE(sut.step({0.03, 0, 0}, nullptr, false, true).has_pressure);
  set.pressure.y = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(sut.step({0.02, 0, 0}, &set, true).has_pressure) << "no world has that";
}

TEST(FeltHand, ShowsNoPressureThatNoFacePressesWith) {
  Shown sut;
  ConstraintSet set = late_wall(0.015, MonotonicTime{} + kEyeStep);
  set.has_pressure = true;
  set.pressure = {-1.5, 0, 0};
  ASSERT_TRUE(sut.step({0.02, 0, 0}, &set, true).has_pressure);
  set.planes[0].normal = {};
  EXPECT_FALSE(sut.step({0.02, 0, 0}, &set, true).has_pressure) << "an unsound plane holds nothing";
  set.planes.clear();
  set.pressure.x = 1e308;
  EXPECT_FALSE(sut.step({0.02, 0, 0}, &set).has_pressure);
}

TEST(FeltHand, ACarriageThatCannotTellIsTakenByItsRoundTrip) {
  FeltHandObserver sut;
  MonotonicTime now{};
  const ConstraintSet set{.sequence = 1};
  for (int i = 1; i <= 40; ++i) {
    now = now + kEyeStep;
    ArmInput input{.now = now, .dt = kEyeStep, .tip = {i * 1e-3, 0, 0}, .fresh = &set};
    input.link.round_trip = 10 * kEyeStep;
    sut.observe(input, {});
  }
  EXPECT_DOUBLE_EQ(sut.felt().hand.x, 30e-3);
  EXPECT_EQ(sut.felt().lag, 10 * kEyeStep);
}

TEST(FeltHand, IsFiniteAndOfTheHandsOwnPathWhateverIsSaid) {
  std::mt19937_64 random(417);
  const auto number = [&](double most) {
    return std::uniform_real_distribution<double>(-most, most)(random);
  };
  const auto hostile = [&] {
    switch (random() % 6) {
      case 0:
        return std::numeric_limits<double>::quiet_NaN();
      case 1:
        return std::numeric_limits<double>::infinity();
      case 2:
        return number(1e300);
      default:
        return number(0.05);
    }
  };
  for (int run = 0; run < 300; ++run) {
    Shown sut;
    for (int i = 0; i < 40; ++i) {
      ConstraintSet set{.sequence = random(),
                        .sampled_at = MonotonicTime{} + kEyeStep * static_cast<int>(random() % 99)};
      for (std::uint64_t n = random() % 9; n > 0; --n) {
        Direction3 normal{hostile(), hostile(), hostile()};
        if (random() % 2 == 0) normal = {random() % 2 == 0 ? 1.0 : -1.0, 0, 0};
        set.planes.push_back({.normal = normal, .offset_m = hostile()});
      }
      set.has_ghost = random() % 2 == 0;
      set.ghost = {hostile(), hostile(), hostile()};
      set.has_far = random() % 4 == 0;
      set.far.slave = {hostile(), hostile(), hostile()};
      const Position3 tip{hostile(), number(0.05), number(0.05)};
      const FeltHand& shown =
          sut.step(tip, random() % 3 == 0 ? nullptr : &set, random() % 2 == 0, random() % 9 == 0);
      EXPECT_TRUE(is_finite(shown.hand)) << run << ' ' << i;
      EXPECT_TRUE(!shown.has_ghost || is_finite(shown.ghost));
      EXPECT_GE(shown.lag, Duration{});
    }
  }
}

}  // namespace
}  // namespace thimble::coupling
