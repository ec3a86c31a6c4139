#include "daemon/app/return_watch.hpp"

#include <gtest/gtest.h>

#include <random>

namespace thimble::app {
namespace {

using Change = ReturnWatch::Change;

TEST(ReturnWatch, TellsOnceOfAnArmThatLeftAndOnceOfItsReturn) {
  ReturnWatch sut;
  EXPECT_EQ(sut.note(1, OperatingState::Active), Change::None);
  EXPECT_EQ(sut.note(1, OperatingState::Lost), Change::Left);
  EXPECT_EQ(sut.note(1, OperatingState::Lost), Change::None);
  EXPECT_EQ(sut.note(0, OperatingState::Discovered), Change::None) << "of another";
  EXPECT_EQ(sut.note(1, OperatingState::Calibrating), Change::Returned);
  EXPECT_EQ(sut.note(1, OperatingState::Inactive), Change::None);
}

TEST(ReturnWatch, SaysNothingOfAnArmThatWasNeverThere) {
  ReturnWatch sut;
  EXPECT_EQ(sut.note(0, OperatingState::Lost), Change::None);
  sut.forget(0);
  sut.forget(7);
  EXPECT_EQ(sut.note(0, OperatingState::Opened), Change::None);
  sut.forget(0);
  EXPECT_EQ(sut.note(0, OperatingState::Lost), Change::None) << "that one never was";
}

// As often as one goes it can come back, and no more often.
TEST(ReturnWatch, CountsAsManyReturnsAsLossesThatEnded) {
  std::mt19937 random(1);
  ReturnWatch sut;
  int begun = 0;
  int ended = 0;
  int left = 0;
  int returned = 0;
  bool is_lost = false;
  for (int i = 0; i < 1000; ++i) {
    const bool is_next_lost = i > 0 && random() % 3 == 0;
    if (is_lost && !is_next_lost) ++ended;
    if (!is_lost && is_next_lost) ++begun;
    is_lost = is_next_lost;
    const Change told = sut.note(3, is_lost ? OperatingState::Lost : OperatingState::Inactive);
    if (told == Change::Left) ++left;
    if (told == Change::Returned) ++returned;
  }
  EXPECT_EQ(left, begun);
  EXPECT_EQ(returned, ended);
  EXPECT_GT(returned, 0);
}

TEST(ReturnWatch, NamesTheArmThatCameOrWent) {
  config::ArmConfig arm;
  arm.name = "left";
  arm.device = "hid:1209:0001";
  EXPECT_EQ(sentence_of(arm, Change::Returned), "arm 'left': hid:1209:0001 is there again");
  EXPECT_TRUE(sentence_of(arm, Change::Left).starts_with("arm 'left' stopped: "));
}

}  // namespace
}  // namespace thimble::app
