#include "daemon/servo/held_force.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <random>

namespace thimble::servo {
namespace {

using std::chrono::milliseconds;

constexpr Duration kSettled = milliseconds(20);

struct HeldForceTest : testing::Test {
  HeldForce sut{kSettled};
  MonotonicTime now{};

  void tick(bool is_fresh, bool is_zero, bool is_taken = true) {
    now = now + milliseconds(1);
    sut.note_sample(is_fresh);
    sut.note_command(now, is_zero, is_taken);
  }
  // Ticks of zero that are taken, and answered or not, until it is let go; -1: never.
  int zeros_until_let_go(bool is_answered, bool is_taken = true) {
    for (int i = 1; i <= 1000; ++i) {
      tick(is_answered, true, is_taken);
      if (!sut.may_hold()) return i;
    }
    return -1;
  }
};

TEST_F(HeldForceTest, AnArmThatWasToldNoForceHoldsNone) {
  for (int i = 0; i < 100; ++i) tick(true, true);
  EXPECT_FALSE(sut.may_hold());
}

TEST_F(HeldForceTest, FromTheFirstForceOnItMayUntilZerosHaveArrivedForLongEnough) {
  tick(true, false, false);
  EXPECT_TRUE(sut.may_hold()) << "who knows what the bus makes of it";
  EXPECT_EQ(zeros_until_let_go(true), 21);
}

TEST_F(HeldForceTest, OneThatTakesNothingOrSaysNothingKeepsIt) {
  tick(true, false);
  EXPECT_EQ(zeros_until_let_go(true, false), -1);
  EXPECT_EQ(zeros_until_let_go(false), -1) << "its bus takes them, and it may be dead behind it";
  EXPECT_EQ(zeros_until_let_go(true), 1);
}

TEST_F(HeldForceTest, WhatItSaidBeforeTheZerosArrivedIsNoAnswer) {
  tick(true, false);
  tick(true, true);
  tick(true, true);
  EXPECT_EQ(zeros_until_let_go(false), -1);
}

TEST_F(HeldForceTest, AForceBetweenBeginsAnew) {
  tick(true, false);
  for (int i = 0; i < 19; ++i) tick(true, true);
  tick(true, false);
  EXPECT_EQ(zeros_until_let_go(true), 21);
}

TEST_F(HeldForceTest, OfOneThatWasLostTheZerosBeforeCountNothing) {
  tick(true, false);
  for (int i = 0; i < 19; ++i) tick(true, true);
  sut.note_loss();
  EXPECT_TRUE(sut.may_hold());
  EXPECT_EQ(zeros_until_let_go(true), 21);
  sut.note_loss();
  EXPECT_FALSE(sut.may_hold()) << "it held none when it left";
}

// The oracle: an arm that takes each command of which it was told Ok three commands later.
TEST_F(HeldForceTest, IsNeverLetGoWhileABusThatIsThreeCommandsBehindStillHasAForce) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 200; ++round) {
    int forces_under_way = 0;  // commands until the last force is at zero behind it
    for (int i = 0; i < 300; ++i) {
      const bool is_zero = random() % 8 != 0 || i > 200;
      const bool is_taken = random() % 3 != 0;
      tick(random() % 2 == 0, is_zero, is_taken);
      if (!is_zero)
        forces_under_way = 3;
      else if (is_taken && forces_under_way > 0)
        --forces_under_way;
      ASSERT_TRUE(sut.may_hold() || forces_under_way == 0);
    }
  }
}

}  // namespace
}  // namespace thimble::servo
