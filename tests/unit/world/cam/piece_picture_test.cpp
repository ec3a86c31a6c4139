#include <gtest/gtest.h>

#include "tests/unit/world/cam/hand_in_world.hpp"

// What a board shows of its pieces on a monitor of its own.
namespace thimble::world::cam {
namespace {

using std::chrono::milliseconds;
using test::at;
using test::kSpace;

class PiecePictureTest : public test::HandInWorld {
 protected:
  const sim::cam::VideoMonitor& monitor() { return slot_->board().machine().monitor(); }
  std::uint64_t pictures() { return world_->board().counters().pictures; }
  std::uint64_t moves() { return world_->board().counters().moves; }
};

TEST_F(PiecePictureTest, ThereIsNoneUnlessItIsAskedFor) {
  for (int x = 16; x < 30; ++x) hold(at(x, 16));
  EXPECT_GT(moves(), 7U);
  EXPECT_EQ(pictures(), 0U);
  EXPECT_EQ(monitor().frames(), 0U);
}

TEST_F(PiecePictureTest, ThereIsOneOfEachSeventhMove) {
  begin({.space = kSpace, .moves_a_picture = 7});
  for (int i = 0; i < 200; ++i) {
    hold(at(14 + i % 16, 22), milliseconds(7));
    ASSERT_GE(moves(), 7 * pictures());
    ASSERT_LE(moves(), 7 * pictures() + 7) << "the eighth waits until the picture is drawn";
  }
  EXPECT_GT(pictures(), 5U);
  EXPECT_GE(monitor().frames(), pictures());
  EXPECT_LE(monitor().frames(), pictures() + 1) << "one may be under way";
  EXPECT_FALSE(world_->board().trouble());
}

TEST_F(PiecePictureTest, ItHasThePiecesRowByRow) {
  begin({.space = kSpace, .moves_a_picture = 1});
  hold(at(20, 20), milliseconds(300));
  const PieceLayout layout = test::one_square();
  for (int y = 0; y < 32; ++y) {
    const auto line = monitor().line(static_cast<std::size_t>(y));
    ASSERT_EQ(line.size(), 32U);
    for (int x = 0; x < 32; ++x) {
      const std::uint16_t bits = line[static_cast<std::size_t>(x)];
      EXPECT_EQ(cell::part_of(bits), layout[index_of(kSpace, {x, y, 0})]);
      EXPECT_EQ((bits & cell::kGrasp) != 0, x == 20 && y == 20);
    }
  }
}

// A frame and its wait are shorter than what is overdue.
TEST_F(PiecePictureTest, WhatTheLastMoveFoundIsFeltMeanwhile) {
  begin({.space = kSpace, .moves_a_picture = 1});
  hold(at(16, 15), milliseconds(100));
  ASSERT_EQ(hold(at(9, 15), milliseconds(100)).planes.size(), 1U);
  const std::uint64_t before = pictures();
  for (int i = 0; i < 300; ++i) {
    const ProbeMotion motion = hold(at(9, 15), milliseconds(1));
    ASSERT_FALSE(motion.is_silent) << i;
    ASSERT_EQ(motion.planes.size(), 1U) << i;
  }
  EXPECT_GT(pictures(), before);
}

// A board at a clock that no monitor has.
TEST_F(PiecePictureTest, ABoardThatShowsNothingIsFeltAllTheSame) {
  const PieceSettings settings{.space = kSpace, .moves_a_picture = 1};
  world_.reset();
  slot_ = std::make_unique<sim::cam::SimCamBoard>(
      clock_, sim::cam::BoardOptions{
                  .shape = {{2, 1, 1}, 9}, .clock_hz = 10'000'000, .window_bytes = 1 << 20});
  auto slow = PieceWorld::create(
      {.pieces = settings, .source = "pieces"}, [this](MonotonicTime now) { return open(now); },
      test::one_square(), clock_);
  world_ = *std::move(slow);
  probe_ = world_->add_probe(at(16, 16)).value();
  EXPECT_FALSE(world_->board().why_dark());
  hold(at(16, 15), milliseconds(100));
  EXPECT_EQ(hold(at(9, 15), milliseconds(100)).planes.size(), 1U);
  EXPECT_FALSE(world_->board().trouble());
  ASSERT_TRUE(world_->board().why_dark());
  EXPECT_NE(world_->board().why_dark()->message.find("at this clock"), std::string::npos);
  EXPECT_EQ(pictures(), 0U);
  slot_->unplug();
  hold(at(9, 15), milliseconds(500));
  plug_in();  // another one may
  hold(at(9, 15), milliseconds(500));
  EXPECT_FALSE(world_->board().why_dark());
  EXPECT_GT(pictures(), 0U);
}

}  // namespace
}  // namespace thimble::world::cam
