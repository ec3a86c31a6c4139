#include "drivers/cambus/board_watch.hpp"

#include <gtest/gtest.h>

namespace thimble::cambus {
namespace {

constexpr std::uint32_t kIncarnation = 7;
constexpr MonotonicTime kOpened{std::chrono::seconds(5)};

MonotonicTime at_ms(int ms) { return kOpened + std::chrono::milliseconds(ms); }

struct BoardWatchTest : testing::Test {
  BoardWatch sut{facts(), kOpened};

  static BoardFacts facts() {
    BoardFacts out;
    out.incarnation = kIncarnation;
    return out;
  }
  static IdentityWords words(std::uint32_t beat, std::uint32_t incarnation = kIncarnation) {
    IdentityWords out{};
    out[page::kMagic / 4] = page::kMagicValue;
    out[page::kIncarnation / 4] = incarnation;
    out[page::kBeat / 4] = beat;
    return out;
  }
};

TEST_F(BoardWatchTest, TheBoardThatWasOpenedIsThere) {
  EXPECT_EQ(sut.check_identity(words(1)), IoStatus::Ok);
  EXPECT_EQ(sut.why_gone(), Gone::No);
}

TEST_F(BoardWatchTest, AnotherIncarnationAndNoBoardAtAllAreToldApart) {
  BoardWatch other = sut;
  EXPECT_EQ(sut.check_identity(words(1, kIncarnation + 1)), IoStatus::Disconnected);
  EXPECT_EQ(sut.why_gone(), Gone::NewIncarnation);
  EXPECT_EQ(other.check_identity(IdentityWords{}), IoStatus::Disconnected);
  EXPECT_EQ(other.why_gone(), Gone::Silent);
}

TEST_F(BoardWatchTest, ABeatThatChangesInTimeKeepsItAlive) {
  for (int n = 0; n < 20; ++n) {
    const MonotonicTime now = at_ms(n * (page::kBeatGivenUp_ms - 1));
    EXPECT_EQ(sut.check_beat(words(static_cast<std::uint32_t>(n)), now, now), IoStatus::Ok) << n;
  }
}

// A beat only counts up (docs/cambus.md), so that no other one can have come between.
TEST_F(BoardWatchTest, HoweverSeldomItIsLookedAtAnotherBeatIsALifeAndTheSameIsNone) {
  for (int n = 0; n < 5; ++n) {
    const MonotonicTime now = at_ms(n * 3'600'000);
    const auto beats = static_cast<std::uint32_t>(n * 36'000);
    EXPECT_EQ(sut.check_beat(words(beats), now, now), IoStatus::Ok) << n;
  }
  const MonotonicTime later = at_ms(5 * 3'600'000);
  EXPECT_EQ(sut.check_beat(words(4 * 36'000), later, later), IoStatus::Disconnected);
  EXPECT_EQ(sut.why_gone(), Gone::NoBeat);
}

TEST_F(BoardWatchTest, ABeatThatStandsIsGivenUpByTheTimeOfTheQuestionNotOfTheAnswer) {
  ASSERT_EQ(sut.check_beat(words(1), at_ms(0), at_ms(10)), IoStatus::Ok);
  const int last_ms = 10 + page::kBeatGivenUp_ms - 1;
  EXPECT_EQ(sut.check_beat(words(1), at_ms(last_ms), at_ms(last_ms + 500)), IoStatus::Ok);
  EXPECT_EQ(sut.check_beat(words(1), at_ms(last_ms + 1), at_ms(last_ms + 1)),
            IoStatus::Disconnected);
  EXPECT_EQ(sut.why_gone(), Gone::NoBeat);
}

TEST_F(BoardWatchTest, WhyItWasGivenUpFirstStays) {
  EXPECT_EQ(sut.give_up(Gone::Unplugged), IoStatus::Disconnected);
  EXPECT_EQ(sut.check_identity(words(1)), IoStatus::Disconnected);
  EXPECT_EQ(sut.check_identity(words(1, kIncarnation + 1)), IoStatus::Disconnected);
  EXPECT_EQ(sut.check_beat(words(2), at_ms(900), at_ms(900)), IoStatus::Disconnected);
  EXPECT_EQ(sut.why_gone(), Gone::Unplugged);
}

}  // namespace
}  // namespace thimble::cambus
