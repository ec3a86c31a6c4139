#include "daemon/safety/estop_channels.hpp"

#include <gtest/gtest.h>

#include <array>

namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

struct EstopChannelsTest : testing::Test {
  MonotonicTime now{};

  // Every millisecond for that long.
  void run(EstopChannels& sut, bool a, bool b, Duration duration) {
    const std::array<bool, 2> is_closed{a, b};
    for (Duration run{}; run < duration; run += milliseconds(1)) {
      sut.step(is_closed);
      sut.compare(is_closed, now);
      now = now + milliseconds(1);
    }
  }
};

TEST_F(EstopChannelsTest, IsOpenBeforeTheFirstLook) { EXPECT_TRUE(EstopChannels(2).is_open()); }

TEST_F(EstopChannelsTest, OneChannelIsJudgedAlone) {
  EstopChannels sut(1);
  run(sut, true, false, milliseconds(500));
  EXPECT_FALSE(sut.is_open());
  EXPECT_FALSE(sut.has_disagreed());
  run(sut, false, true, milliseconds(500));
  EXPECT_TRUE(sut.is_open());
  EXPECT_FALSE(sut.has_disagreed());
}

TEST_F(EstopChannelsTest, EitherOfTwoChannelsIsAStopAtOnce) {
  for (const bool is_first : {true, false}) {
    EstopChannels sut(2);
    run(sut, true, true, milliseconds(10));
    EXPECT_FALSE(sut.is_open());
    run(sut, !is_first, is_first, milliseconds(1));
    EXPECT_TRUE(sut.is_open());
  }
}

TEST_F(EstopChannelsTest, FiftyMillisecondsApartIsHowContactsMoveAndMoreIsADefect) {
  EstopChannels sut(2);
  run(sut, true, true, milliseconds(10));
  run(sut, false, true, milliseconds(51));  // seen at 0 to 50 ms
  EXPECT_FALSE(sut.has_disagreed());
  run(sut, false, true, milliseconds(1));
  EXPECT_TRUE(sut.has_disagreed());
}

TEST_F(EstopChannelsTest, AWeldedContactIsNotMadeGoodByReleasingTheButton) {
  EstopChannels sut(2);
  run(sut, true, true, milliseconds(10));
  for (int press = 0; press < 3; ++press) {
    run(sut, false, true, milliseconds(300));  // the second is welded
    run(sut, true, true, milliseconds(1000));
    EXPECT_FALSE(sut.is_open());
    EXPECT_TRUE(sut.has_disagreed());
  }
}

TEST_F(EstopChannelsTest, BothSeenOpenTogetherMendIt) {
  EstopChannels sut(2);
  run(sut, false, true, milliseconds(300));
  run(sut, false, false, milliseconds(5));
  EXPECT_FALSE(sut.has_disagreed());
  EXPECT_TRUE(sut.is_open());
  run(sut, true, true, milliseconds(5));
  EXPECT_FALSE(sut.is_open());
}

TEST_F(EstopChannelsTest, ShortDisagreementsDoNotAddUp) {
  EstopChannels sut(2);
  for (int i = 0; i < 20; ++i) {
    run(sut, i % 2 == 0, i % 2 != 0, milliseconds(20));
    run(sut, true, true, milliseconds(5));
  }
  EXPECT_FALSE(sut.has_disagreed());
}

TEST_F(EstopChannelsTest, WhichOfThemIsOpenDoesNotMatterForHowLong) {
  EstopChannels sut(2);
  run(sut, true, false, milliseconds(30));
  run(sut, false, true, milliseconds(30));
  EXPECT_TRUE(sut.has_disagreed()) << "they have not agreed for 60 ms";
}

TEST_F(EstopChannelsTest, EdgesThatAreToldApartOpenItAndAreNoDefect) {
  EstopChannels sut(2);
  for (int i = 0; i < 200; ++i) {
    sut.step(std::array<bool, 2>{true, false});
    sut.compare(std::array<bool, 2>{true, true}, now);
    now = now + milliseconds(1);
  }
  EXPECT_TRUE(sut.is_open());
  EXPECT_FALSE(sut.has_disagreed());
}

TEST_F(EstopChannelsTest, AReadingThatIsOldIsNoLongerDisagreement) {
  EstopChannels sut(2);
  for (int i = 0; i < 200; ++i) sut.compare(std::array<bool, 2>{true, false}, now);
  EXPECT_FALSE(sut.has_disagreed()) << "it was read once";
}

}  // namespace
}  // namespace thimble::safety
