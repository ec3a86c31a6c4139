#include "drivers/phantom/zero_jump.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace thimble::phantom {
namespace {

using Counts = ZeroJump::Counts;
using std::chrono::milliseconds;

struct ZeroJumpTest : testing::Test {
  ZeroJump sut;
  void stay(const Counts& counts, int reports) {
    for (int i = 0; i < reports; ++i) sut.on_counts(counts, milliseconds(1));
  }
};

TEST_F(ZeroJumpTest, AnArmThatIsHeldStillAndWhoseCountersFallToZeroWasPressed) {
  stay({500, -3, 20}, 30);
  EXPECT_FALSE(sut.is_pressed());
  stay({0, 1, -1}, 1);
  EXPECT_TRUE(sut.is_pressed());
  stay({2, 3, 1}, 100);
  EXPECT_TRUE(sut.is_pressed()) << "until it is lowered";
  sut.lower();
  stay({2, 3, 1}, 100);
  EXPECT_FALSE(sut.is_pressed());
}

TEST_F(ZeroJumpTest, TheFirstReportsAreNoJump) {
  stay({0, 0, 0}, 100);
  EXPECT_FALSE(sut.is_pressed());
}

// arms.md 3.1: before its first press a controller may make up counter a, echo the command in b.
TEST_F(ZeroJumpTest, MadeUpCountersAreNoPressHoweverLongTheyGoOn) {
  for (int i = 0; i < 200'000; ++i) {
    const double a = 8000 + 4000 * std::sin(0.0002 * i);
    sut.on_counts({static_cast<std::int32_t>(a), 0, 7}, milliseconds(1));
    ASSERT_FALSE(sut.is_pressed()) << i;
  }
  stay({0, 0, 0}, 1);
  EXPECT_TRUE(sut.is_pressed()) << "the press ends them";
}

TEST_F(ZeroJumpTest, AJumpElsewhereOrOfAMovingArmIsNone) {
  stay({500, 500, 500}, 30);
  stay({0, 500, 0}, 30);
  EXPECT_FALSE(sut.is_pressed()) << "not all are near zero";
  for (std::int32_t at = 500; at > 100; at -= 10) stay({at, 0, 0}, 1);
  stay({0, 0, 0}, 1);
  EXPECT_FALSE(sut.is_pressed()) << "it moved";
}

TEST_F(ZeroJumpTest, ALineThatWasBrokenOnceIsTakenBack) {
  stay({500, 0, 0}, 30);
  stay({0, 0, 0}, 1);
  EXPECT_TRUE(sut.is_pressed());
  stay({500, 0, 0}, 1);
  EXPECT_FALSE(sut.is_pressed());
}

TEST_F(ZeroJumpTest, MissingReportsAreNoJump) {
  stay({500, 0, 0}, 30);
  sut.forget();
  stay({0, 0, 0}, 30);
  EXPECT_FALSE(sut.is_pressed());
}

// No hand: speeds of up to 100 counts a report, with rests, through zero and anywhere.
TEST_F(ZeroJumpTest, NoMotionIsAPress) {
  std::mt19937 random(4);
  Counts counts{300, -200, 100};
  for (int i = 0; i < 100'000; ++i) {
    const bool is_resting = (i / 100) % 2 == 0;
    // What a hand does after a rest: faster by 10 counts a report at most.
    const int most = is_resting ? 1 : std::min(100, 10 * (i % 100));
    for (std::int32_t& count : counts) {
      const auto step =
          static_cast<std::int32_t>(random() % (2U * static_cast<unsigned>(most) + 1));
      count += step - most - (count > 400 ? 20 : 0) + (count < -400 ? 20 : 0);
    }
    sut.on_counts(counts, milliseconds(1));
    ASSERT_FALSE(sut.is_pressed()) << i;
  }
}

TEST_F(ZeroJumpTest, AnyCountersAreSafe) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  stay({kMost, kLeast, 0}, 30);
  stay({kLeast, kMost, 0}, 30);
  EXPECT_FALSE(sut.is_pressed());
}

}  // namespace
}  // namespace thimble::phantom
