#include "daemon/coupling/constraint_age.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace thimble::coupling {
namespace {

using std::chrono::milliseconds;

// One watch, stepped in virtual time.
class AgeBench {
 public:
  explicit AgeBench(Duration dt = milliseconds(1)) : dt_(dt) { sut.restart(now_); }

  void reply() { step(true); }
  void silence(Duration span) {
    for (Duration gone{}; gone < span; gone += dt_) step(false);
  }

  ConstraintAge sut{ConstraintAgeSettings{}};
  LinkQuality link{};

 private:
  void step(bool has_reply) {
    now_ = now_ + dt_;
    ArmInput input{.now = now_, .dt = dt_};
    input.link = link;
    input.fresh = has_reply ? &set_ : nullptr;
    sut.update(input);
  }

  Duration dt_;
  MonotonicTime now_{};
  ConstraintSet set_{};
};

TEST(ConstraintAge, FreezesAfterTwentyMillisecondsOnAFastLink) {
  AgeBench bench;
  bench.reply();
  bench.silence(milliseconds(20));
  EXPECT_FALSE(bench.sut.is_frozen());
  bench.silence(milliseconds(1));
  EXPECT_TRUE(bench.sut.is_frozen());
  EXPECT_FALSE(bench.sut.is_fading());
  bench.reply();
  EXPECT_FALSE(bench.sut.is_frozen());
}

TEST(ConstraintAge, FreezesAfterThreeRoundTripsOnASlowLink) {
  AgeBench bench;
  bench.link.round_trip = milliseconds(200);
  bench.reply();
  bench.silence(milliseconds(600));
  EXPECT_FALSE(bench.sut.is_frozen());
  bench.silence(milliseconds(1));
  EXPECT_TRUE(bench.sut.is_frozen());
}

TEST(ConstraintAge, FadesOverATenthOfASecondAfterAQuarter) {
  for (const Duration dt : {Duration(milliseconds(1)), Duration(std::chrono::microseconds(125)),
                            Duration(milliseconds(2))}) {
    AgeBench bench(dt);
    bench.reply();
    bench.silence(milliseconds(250));
    EXPECT_FALSE(bench.sut.is_fading());
    EXPECT_EQ(bench.sut.gain(), 1);
    bench.silence(milliseconds(50));
    EXPECT_TRUE(bench.sut.is_fading());
    EXPECT_NEAR(bench.sut.gain(), 0.5, 0.01);
    EXPECT_FALSE(bench.sut.has_expired());
    bench.silence(milliseconds(51));
    EXPECT_EQ(bench.sut.gain(), 0);
    EXPECT_TRUE(bench.sut.has_expired());
  }
}

TEST(ConstraintAge, JitterAddsToThePatienceBeforeFading) {
  AgeBench bench;
  bench.link = {.is_up = true, .round_trip = milliseconds(100), .jitter = milliseconds(30)};
  bench.reply();
  bench.silence(milliseconds(330));
  EXPECT_TRUE(bench.sut.is_frozen());
  EXPECT_FALSE(bench.sut.is_fading());
  bench.silence(milliseconds(1));
  EXPECT_TRUE(bench.sut.is_fading());
}

TEST(ConstraintAge, ComesBackAsSlowlyAsItFaded) {
  AgeBench bench;
  bench.reply();
  bench.silence(milliseconds(400));
  bench.reply();
  EXPECT_TRUE(bench.sut.has_returned());
  EXPECT_FALSE(bench.sut.is_fading());
  EXPECT_NEAR(bench.sut.gain(), 0.01, 1e-9);
  bench.silence(milliseconds(1));
  EXPECT_FALSE(bench.sut.has_returned());
  for (int i = 0; i < 100; ++i) bench.reply();
  EXPECT_EQ(bench.sut.gain(), 1);
}

TEST(ConstraintAge, WorldThatNeverAnswersIsFlagged) {
  AgeBench bench;
  bench.silence(milliseconds(400));
  EXPECT_TRUE(bench.sut.is_frozen());
  EXPECT_TRUE(bench.sut.has_expired());
}

TEST(ConstraintAge, NegativeRoundTripDoesNotFreeze) {
  AgeBench bench;
  bench.link.round_trip = Duration(-5);
  bench.reply();
  EXPECT_FALSE(bench.sut.is_frozen());
}

}  // namespace
}  // namespace thimble::coupling
