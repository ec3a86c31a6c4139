#include "daemon/app/return_watch.hpp"

#include <gtest/gtest.h>

#include <random>

namespace thimble::app {
namespace {

TEST(ReturnWatch, TellsOnceOfAnArmThatWasLostAndIsBack) {
  ReturnWatch sut;
  EXPECT_FALSE(sut.note(1, OperatingState::Active));
  EXPECT_FALSE(sut.note(1, OperatingState::Lost));
  EXPECT_FALSE(sut.note(1, OperatingState::Lost));
  EXPECT_FALSE(sut.note(0, OperatingState::Discovered)) << "of another";
  EXPECT_TRUE(sut.note(1, OperatingState::Calibrating));
  EXPECT_FALSE(sut.note(1, OperatingState::Inactive));
}

TEST(ReturnWatch, SaysNothingOfAnArmThatWasNeverThere) {
  ReturnWatch sut;
  EXPECT_FALSE(sut.note(0, OperatingState::Lost));
  sut.forget(0);
  sut.forget(7);
  EXPECT_FALSE(sut.note(0, OperatingState::Opened));
}

// As often as one goes it can come back, and no more often.
TEST(ReturnWatch, CountsAsManyReturnsAsLossesThatEnded) {
  std::mt19937 random(1);
  ReturnWatch sut;
  int ended = 0;
  int told = 0;
  bool is_lost = false;
  for (int i = 0; i < 1000; ++i) {
    const bool is_next_lost = random() % 3 == 0;
    if (is_lost && !is_next_lost) ++ended;
    is_lost = is_next_lost;
    if (sut.note(3, is_lost ? OperatingState::Lost : OperatingState::Inactive)) ++told;
  }
  EXPECT_EQ(told, ended);
  EXPECT_GT(told, 0);
}

}  // namespace
}  // namespace thimble::app
