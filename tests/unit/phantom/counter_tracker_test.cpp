#include "drivers/phantom/counter_tracker.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/phantom/find_model.hpp"
#include "drivers/phantom/phantom_kinematics.hpp"

namespace thimble::phantom {
namespace {

using std::chrono::milliseconds;

std::int16_t wrapped(std::int32_t counts) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(counts & 0xffff));
}

// An arm without stops: its counters go round and round.
PhantomModel endless() {
  PhantomModel model = *find_model("phantom-vintage");
  model.joint_min_rad = {-1e9, -1e9, -1e9};
  model.joint_max_rad = {1e9, 1e9, 1e9};
  return model;
}

class CounterTrackerTest : public testing::Test {
 protected:
  CounterTracker sut{*find_model("phantom-vintage")};
};

TEST_F(CounterTrackerTest, BoundsAStepByTheMotorSpeedLimit) {
  // 1050 rad/s · 4000 counts / 2π = 668451 counts/s, for the time and 1 ms more.
  EXPECT_EQ(sut.largest_step(0, milliseconds(1)), 1336);
  EXPECT_EQ(sut.largest_step(0, milliseconds(9)), 6684);
  EXPECT_EQ(sut.largest_step(0, milliseconds(0)), 668);
  EXPECT_EQ(sut.largest_step(0, -milliseconds(5)), 668);
}

TEST_F(CounterTrackerTest, BoundsAStepByTheWayBetweenTheStops) {
  // (160 degrees + 0.6 rad) · 117/13 · 4000 counts / 2π for the waist.
  EXPECT_NEAR(sut.largest_step(0, milliseconds(400)), 19437, 2);
  EXPECT_NEAR(sut.largest_step(1, milliseconds(400)), 16629, 2);
}

// What makes a gap harmless: see the class comment.
TEST(CounterTracker, NoArmOfTheTableTurnsAMotorHalfTheRangeOfItsCounter) {
  for (const PhantomModel& model : kPhantomModels) {
    const CounterTracker sut(model);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LE(sut.largest_step(i, std::chrono::hours(1)), CounterTracker::kHalfRange_counts)
          << model.name;
    }
  }
}

// From any pose to any other within the stops, whatever the counters wrapped through meanwhile.
TEST_F(CounterTrackerTest, AGapOfAnyLengthLeavesNoDoubtWhereTheArmIs) {
  std::mt19937 random(8);
  std::uniform_int_distribution<int> waist(-9700, 9700), other(-8700, 7800);
  sut.restart({});
  for (int round = 0; round < 10'000; ++round) {
    const CounterTracker::Raw raw{wrapped(waist(random)), wrapped(other(random)), 0};
    ASSERT_TRUE(sut.follow(raw, milliseconds(400)));
    ASSERT_EQ(sut.counts()[0].value, raw[0]);
    ASSERT_EQ(sut.counts()[1].value, raw[1]);
  }
}

TEST(CounterTracker, AnArmThatTurnsFurtherIsFollowedForAsLongAsItsWayIsCertain) {
  const PhantomModel model = endless();
  CounterTracker sut(model);
  // 668451 counts/s reach half the range after 49 ms, 1 ms of which is slack.
  for (const int sign : {-1, 1}) {
    sut.restart({});
    ASSERT_TRUE(sut.follow({wrapped(sign * 32'000), 0, 0}, milliseconds(48)));
    EXPECT_EQ(sut.counts()[0].value, sign * 32'000);
    EXPECT_FALSE(sut.follow({wrapped(sign * 32'000), 0, 0}, milliseconds(49)))
        << "it may have gone once round";
  }
}

TEST_F(CounterTrackerTest, RefusesAJointBeyondItsStopsAndTheMargin) {
  for (std::size_t joint = 0; joint < 3; ++joint) {
    for (const int sign : {-1, 1}) {
      sut.restart({});
      CounterTracker::Raw raw{};
      int counts = 0;
      while (counts < 20'000) {
        raw[joint] = wrapped(sign * (counts + 100));
        if (!sut.follow(raw, milliseconds(1))) break;
        counts += 100;
      }
      const auto& model = *find_model("phantom-vintage");
      const double turned_rad =
          body_angles(model, sut.counts())[joint] - model.home_angle_rad[joint];
      const double stop_rad = (sign > 0 ? model.joint_max_rad : model.joint_min_rad)[joint] -
                              model.home_angle_rad[joint];
      EXPECT_NEAR(turned_rad, stop_rad + sign * CounterTracker::kMargin_rad, 0.025);
      EXPECT_EQ(sut.counts()[joint].value, sign * counts) << "and stays where it was";
    }
  }
}

TEST_F(CounterTrackerTest, StartsFromTheSignedValueOfTheCounters) {
  sut.restart({5, -7, 32767});
  EXPECT_EQ(sut.counts(), (std::array<EncoderCounts, 3>{{{5}, {-7}, {32767}}}));
}

TEST(CounterTracker, FollowsRandomMotionThroughAnyNumberOfWraps) {
  const PhantomModel model = endless();
  CounterTracker sut(model);
  std::mt19937 random(3);
  std::uniform_int_distribution<int> any_step(-1336, 1336);
  std::array<std::int32_t, 3> truth{};
  sut.restart({});
  int wraps = 0;
  for (int tick = 0; tick < 200'000; ++tick) {
    CounterTracker::Raw raw{};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t before = truth[i];
      // Drift, so that the counters go round and round.
      truth[i] += (any_step(random) + (i == 0 ? 1336 : -1336)) / 2;
      raw[i] = wrapped(truth[i]);
      wraps += (before >> 16) != (truth[i] >> 16) ? 1 : 0;
    }
    ASSERT_TRUE(sut.follow(raw, milliseconds(1)));
    for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(sut.counts()[i].value, truth[i]);
  }
  EXPECT_GT(wraps, 1000);
}

TEST(CounterTracker, NeverOverflowsHoweverFarItIsTurned) {
  const PhantomModel model = endless();
  CounterTracker sut(model);
  for (const int sign : {-1, 1}) {
    sut.restart({0, 1, 0});  // not all zero: that is a reset
    std::int32_t turned = 0;
    while (sut.follow({wrapped(turned + sign * 32'000), 1, 0}, milliseconds(48))) {
      turned += sign * 32'000;
    }
    EXPECT_EQ(sut.counts()[0].value, turned);
    EXPECT_NEAR(turned, sign * (1 << 29), 32'000);
  }
}

TEST_F(CounterTrackerTest, RefusesAStepThatNoMotorMakesAndStaysWhereItWas) {
  for (std::size_t joint = 0; joint < 3; ++joint) {
    for (const int sign : {-1, 1}) {
      sut.restart({100, 100, 100});
      CounterTracker::Raw raw{100, 100, 100};
      raw[joint] = wrapped(100 + sign * 1337);
      EXPECT_FALSE(sut.follow(raw, milliseconds(1)));
      EXPECT_EQ(sut.counts()[joint].value, 100);
      raw[joint] = wrapped(100 + sign * 1336);
      EXPECT_TRUE(sut.follow(raw, milliseconds(1)));
    }
  }
}

TEST_F(CounterTrackerTest, TakesZeroOfAllCountersAfterAStepForAReset) {
  sut.restart({201, 30, -5});
  EXPECT_FALSE(sut.follow({0, 0, 0}, milliseconds(1)));
  EXPECT_TRUE(sut.follow({0, 0, 1}, milliseconds(1)));
  sut.restart({200, 30, -5});
  EXPECT_TRUE(sut.follow({0, 0, 0}, milliseconds(1)));
}

}  // namespace
}  // namespace thimble::phantom
