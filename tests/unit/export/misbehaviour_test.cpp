#include "sim/export/misbehaviour.hpp"

#include <gtest/gtest.h>

#include <array>

namespace thimble::sim {
namespace {

using Room = std::array<std::uint8_t, 64>;

TEST(MisbehaviourTest, LeavesReportsAloneUnlessTold) {
  Misbehaviour sut(1);
  Room room{1, 2, 3};
  EXPECT_EQ(sut.spoil(room, 3), 3U);
  EXPECT_EQ(room, (Room{1, 2, 3}));
  EXPECT_FALSE(sut.refuses({}));
  EXPECT_FALSE(sut.is_silent({}));
}

TEST(MisbehaviourTest, CorruptsSoManyReportsAndNoMore) {
  Misbehaviour sut(1);
  sut.corrupt(3);
  int spoiled = 0;
  for (int i = 0; i < 10; ++i) {
    Room room{};
    EXPECT_EQ(sut.spoil(room, 14), 14U);
    if (room != Room{}) ++spoiled;
    for (std::size_t byte = 14; byte < room.size(); ++byte) EXPECT_EQ(room[byte], 0);
  }
  EXPECT_EQ(sut.struck(), (Misbehaviour::Struck{.corrupted = 3}));
  EXPECT_LE(spoiled, 3);
  EXPECT_GE(spoiled, 2) << "two flips may meet";
}

TEST(MisbehaviourTest, TheSameSeedSpoilsAlike) {
  Misbehaviour one(7);
  Misbehaviour other(7);
  one.corrupt(5);
  other.corrupt(5);
  for (int i = 0; i < 5; ++i) {
    Room a{};
    Room b{};
    (void)one.spoil(a, 20);
    (void)other.spoil(b, 20);
    EXPECT_EQ(a, b);
  }
}

TEST(MisbehaviourTest, CutsToHalfAndBabbles) {
  Misbehaviour sut(1);
  Room room{};
  sut.shorten(1);
  EXPECT_EQ(sut.spoil(room, 14), 7U);
  sut.babble(2);
  EXPECT_EQ(sut.spoil(room, 14), 29U);
  EXPECT_GT(sut.spoil(room, room.size()), room.size()) << "beyond its room";
  EXPECT_EQ(sut.spoil(room, 14), 14U);
  EXPECT_EQ(sut.struck(), (Misbehaviour::Struck{.shortened = 1, .babbled = 2}));
}

TEST(MisbehaviourTest, TakesTheFirstHalfOfSoManyThatItIsSentAndNoMore) {
  Misbehaviour sut(1);
  const Room room{1, 2, 3};
  sut.cut_what_comes(2);
  const auto take = [&](std::span<const std::uint8_t> sent) {
    const auto taken = sut.taken_of(sent);
    sut.note_taken(sent);
    return taken;
  };
  EXPECT_EQ(take({}).size(), 0U) << "of nothing there is no half";
  EXPECT_EQ(sut.taken_of(room).size(), 32U) << "and was not taken";
  EXPECT_EQ(take(room).size(), 32U);
  EXPECT_EQ(take(std::span(room).first(1)).size(), 0U);
  const auto whole = take(room);
  EXPECT_EQ(whole.size(), room.size());
  EXPECT_EQ(whole.data(), room.data());
  EXPECT_EQ(sut.struck(), (Misbehaviour::Struck{.cut = 2}));
}

TEST(MisbehaviourTest, ANakIsNotSpoiled) {
  Misbehaviour sut(1);
  sut.babble(1);
  Room room{};
  EXPECT_EQ(sut.spoil(room, 0), 0U);
  EXPECT_EQ(sut.spoil(room, 1), 3U) << "the next report is";
  EXPECT_EQ(sut.struck().babbled, 1U);
}

TEST(MisbehaviourTest, StallsAndIsSilentUntilItsTime) {
  Misbehaviour sut(1);
  const MonotonicTime t{std::chrono::seconds(1)};
  sut.stall_until(t);
  EXPECT_TRUE(sut.refuses({}));
  EXPECT_FALSE(sut.refuses(t));
  sut.be_silent_until(t);
  EXPECT_TRUE(sut.is_silent({}));
  EXPECT_FALSE(sut.is_silent(t));
  sut.note_unanswered();
  EXPECT_EQ(sut.struck(), (Misbehaviour::Struck{.refused = 1, .unanswered = 1}));
}

}  // namespace
}  // namespace thimble::sim
