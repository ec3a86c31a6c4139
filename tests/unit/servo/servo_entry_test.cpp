#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tests/unit/servo/scripted_rig.hpp"

// Nobody is pushed who was never in the world: outside of it all is matter.
namespace thimble::servo {
namespace {

constexpr Position3 kInside{0.01, 0.31, -0.02};
constexpr Position3 kOutside{0.01, 0.51, -0.02};

ServoSettings in_a_world() {
  ServoSettings settings;
  settings.entry = {{0, 0.3, 0}, {0.045, 0.045, 0.03}};
  return settings;
}

// Wanted active, and told by its coupling to push with 4 N.
struct EntryRig : ServoRig {
  explicit EntryRig(Position3 tip) : ServoRig(in_a_world()) {
    coupling.wish = {4, 0, 0};
    controls.want_active = true;
    device.state.tip = tip;
  }
  // In steps that no hand is too fast for.
  void move_to(Position3 tip) {
    const Displacement3 way = tip - device.state.tip;
    for (int i = 0; i < 500; ++i) {
      device.state.tip = device.state.tip + way * (1.0 / 500);
      tick();
    }
    device.state.tip = tip;
    tick();
  }
  [[nodiscard]] bool is_pushed() {
    device.written.clear();
    tick(600);
    return std::any_of(device.written.begin(), device.written.end(),
                       [](const Force3& force) { return force != Force3{}; });
  }
};

TEST(ServoEntry, AnArmOutsideOfItsWorldIsNotDrivenAndIsTold) {
  EntryRig rig(kOutside);
  EXPECT_FALSE(rig.is_pushed());
  EXPECT_EQ(rig.state(), OperatingState::Inactive);
  EXPECT_TRUE(rig.snapshot().is_kept_out);
  EXPECT_EQ(rig.snapshot().faults, 0U);
  EXPECT_TRUE(rig.link.sent.empty()) << "it has no probe in the world";

  rig.controls.want_active = false;
  rig.tick();
  EXPECT_FALSE(rig.snapshot().is_kept_out) << "nobody wants it in";
}

// Bringing it in would not help then.
TEST(ServoEntry, AnArmThatHasNoGuardOrNoSamplesIsNotToldToComeIn) {
  EntryRig rig(kOutside);
  rig.tick(10);
  rig.controls.is_guarded = false;
  rig.tick();
  EXPECT_FALSE(rig.snapshot().is_kept_out);
  rig.controls.is_guarded = true;
  rig.tick();
  EXPECT_TRUE(rig.snapshot().is_kept_out);
  rig.device.next_status = IoStatus::NoData;
  rig.tick(10);
  EXPECT_FALSE(rig.snapshot().is_kept_out);
}

TEST(ServoEntry, BroughtInItIsDrivenWithTheRampOfAnyOther) {
  EntryRig rig(kOutside);
  rig.tick(100);
  rig.device.written.clear();

  rig.move_to(kInside);

  EXPECT_EQ(rig.state(), OperatingState::Active);
  EXPECT_FALSE(rig.snapshot().is_kept_out);
  const auto pushed = std::find_if(rig.device.written.begin(), rig.device.written.end(),
                                   [](const Force3& force) { return force != Force3{}; });
  ASSERT_NE(pushed, rig.device.written.end());
  EXPECT_LT(norm(*pushed), 0.01) << "it begins with nothing";
  EXPECT_TRUE(in_a_world().entry.contains(rig.coupling.reset_tip)) << "so does the ghost, inside";
}

TEST(ServoEntry, WhoWasInsideMayPressOnTheEdgeOfTheWorld) {
  EntryRig rig(kInside);
  rig.tick(600);
  rig.move_to(kOutside);
  EXPECT_TRUE(rig.is_pushed());
  EXPECT_EQ(rig.state(), OperatingState::Active);
  EXPECT_FALSE(rig.snapshot().is_kept_out);
}

TEST(ServoEntry, AfterAStopOutsideTheClearAloneBringsNoForce) {
  EntryRig rig(kInside);
  rig.tick(600);
  rig.move_to(kOutside);
  rig.press_estop();
  rig.tick(10);
  rig.controls.request_clear(rig.snapshot().fault.number);

  EXPECT_FALSE(rig.is_pushed());
  EXPECT_EQ(rig.state(), OperatingState::Inactive);
  EXPECT_TRUE(rig.snapshot().is_kept_out);
  rig.move_to(kInside);
  EXPECT_TRUE(rig.is_pushed());
}

TEST(ServoEntry, ADeadmanThatIsHeldAgainOutsideBringsNoForceUntilTheFingerIsBack) {
  EntryRig rig(kInside);
  rig.tick(600);
  rig.controls.is_deadman_held = false;
  rig.tick(50);
  rig.move_to(kOutside);
  EXPECT_FALSE(rig.snapshot().is_kept_out) << "the deadman comes first";
  rig.controls.is_deadman_held = true;

  EXPECT_FALSE(rig.is_pushed());
  EXPECT_EQ(rig.state(), OperatingState::Active);
  EXPECT_TRUE(rig.snapshot().is_kept_out);
  rig.move_to(kInside);
  EXPECT_TRUE(rig.is_pushed());
  EXPECT_FALSE(rig.snapshot().is_kept_out);
}

// It has no force that could push anybody.
TEST(ServoEntry, APuckMovesItsProbeFromWhereverItIs) {
  ScriptedCoupling coupling;
  ScriptedLink link;
  HandClock clock;
  ScriptedDevice puck(clock);
  puck.able.is_actuated = false;
  puck.state.tip = kOutside;
  ServoControls controls;
  controls.want_active = true;
  ServoLoop sut({puck, coupling, link, controls, clock, clock},
                ServoRig::with_limits(in_a_world()));
  for (int i = 0; i < 20; ++i) {
    clock.advance(std::chrono::milliseconds(1));
    sut.tick(Duration{});
  }
  ServoSnapshot seen;
  ASSERT_TRUE(sut.snapshot(seen));
  EXPECT_EQ(seen.frame.state, OperatingState::Active);
  EXPECT_FALSE(seen.is_kept_out);
}

TEST(EntryBox, IsEverywhereWhereTheWorldHasNoEnd) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(-9, 9);
  for (int i = 0; i < 100; ++i) {
    const Position3 tip{place(random), place(random), place(random)};
    EXPECT_TRUE(EntryBox{}.contains(tip));
    EXPECT_EQ((EntryBox{{}, {0, 1, 0}}.contains(tip)), std::abs(tip.y) <= 1.02);
  }
}

TEST(EntryBox, ContainsWhatLiesBetweenItsFacesAndNoPlaceThatIsNone) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  std::uniform_real_distribution<double> half(0.01, 0.5);
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const EntryBox sut{{place(random), place(random), place(random)},
                       {half(random), half(random), half(random)}};
    const Position3 tip{place(random), place(random), place(random)};
    const auto is_between = [](double at, double middle, double by) {
      return at >= middle - by - 0.02 && at <= middle + by + 0.02;
    };
    const bool is_inside = is_between(tip.x, sut.center.x, sut.half_m[0]) &&
                           is_between(tip.y, sut.center.y, sut.half_m[1]) &&
                           is_between(tip.z, sut.center.z, sut.half_m[2]);
    EXPECT_EQ(sut.contains(tip), is_inside);
    inside += is_inside ? 1 : 0;
  }
  EXPECT_GT(inside, 50);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE((EntryBox{{}, {1, 1, 1}}.contains({0, nan, 0})));
}

}  // namespace
}  // namespace thimble::servo
