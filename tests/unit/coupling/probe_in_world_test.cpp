#include "daemon/coupling/probe_in_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "daemon/coupling/action_counter.hpp"
#include "daemon/coupling/press_counter.hpp"
#include "fake_box.hpp"
#include "hand_samples.hpp"

namespace thimble::coupling {
namespace {

using testing::FakeBox;
using testing::sample;
using world::HandAction;
using Asked = std::array<unsigned, world::kHandActions>;

// The samples of an arm whose person presses its first button, and asks for things besides.
class AskingHand {
 public:
  explicit AskingHand(unsigned seed) : random_(seed) {}

  void ask(HandAction action) {
    counter_.ask(action);
    ++asked_.at(static_cast<std::size_t>(action));
  }
  void ask_something() {
    if (random_() % 9 == 0) ask(HandAction::ToggleFree);
    if (random_() % 23 == 0) ask(HandAction::Reset);
    if (random_() % 7 != 0) return;
    buttons_ ^= 1U;
    pressed_ += buttons_;
  }
  HandSample next() {
    HandSample told = sample(++number_, {});
    told.buttons = buttons_;
    presses_.count(buttons_, told);
    counter_.count(told);
    return told;
  }
  [[nodiscard]] unsigned roll(unsigned sides) { return static_cast<unsigned>(random_() % sides); }
  [[nodiscard]] const Asked& asked() const noexcept { return asked_; }
  [[nodiscard]] unsigned pressed() const noexcept { return pressed_; }

 private:
  std::mt19937 random_;
  std::uint64_t number_{0};
  std::uint32_t buttons_{0};
  unsigned pressed_{0};
  PressCounter presses_;
  ActionCounter counter_;
  Asked asked_{};
};

unsigned presses_of_the_first_button(const FakeBox& box) {
  unsigned heard = 0;
  for (const std::uint32_t press : box.presses) heard += press & 1U;
  return heard;
}

// Of what the hand tells any sample may be lost, come twice, or after later ones.
TEST(ProbeInWorld, HearsWhatIsAskedAsOftenWhateverBecomesOfSamples) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    AskingHand hand(seed);
    FakeBox box(0.015);
    ProbeInWorld sut(box);
    ASSERT_TRUE(sut.open(hand.next()));
    std::vector<HandSample> held_back;
    for (int i = 0; i < 3000; ++i) {
      hand.ask_something();
      const HandSample told = hand.next();
      const unsigned fate = hand.roll(100);
      if (fate < seed) continue;  // lost
      if (fate < 60) {
        held_back.push_back(told);
        continue;
      }
      sut.hear(told);
      if (fate > 95) sut.hear(told);
      if (fate % 5 == 0) {
        for (const HandSample& late : held_back) sut.hear(late);
        held_back.clear();
      }
    }
    for (int i = 0; i < 50; ++i) sut.hear(hand.next());
    EXPECT_EQ(box.asked, hand.asked());
    EXPECT_EQ(presses_of_the_first_button(box), hand.pressed());
  }
}

TEST(ProbeInWorld, WhatWasAskedWhileTheHandWasNotThereIsNobodys) {
  AskingHand hand(1);
  FakeBox box(0.015);
  ProbeInWorld sut(box);
  for (int session = 0; session < 3; ++session) {
    hand.ask(HandAction::ToggleFree);
    hand.ask(HandAction::Reset);
    const HandSample first = hand.next();
    ASSERT_TRUE(sut.open(first));
    sut.hear(first);
    sut.hear(hand.next());
    EXPECT_EQ(box.asked, (Asked{}));
    sut.close();
  }
  ASSERT_TRUE(sut.open(hand.next()));
  hand.ask(HandAction::Reset);
  sut.hear(hand.next());
  EXPECT_EQ(box.asked, (Asked{0, 1}));
}

// The counts of an arm that started anew are smaller than those of the one before it.
TEST(ProbeInWorld, AnArmThatStartedAnewAsksNothingAgain) {
  FakeBox box(0.015);
  ProbeInWorld sut(box);
  AskingHand before(1);
  ASSERT_TRUE(sut.open(before.next()));
  for (int i = 0; i < 7; ++i) {
    before.ask(HandAction::ToggleFree);
    sut.hear(before.next());
  }
  AskingHand after(2);
  ASSERT_TRUE(sut.open(after.next()));
  sut.hear(after.next());
  EXPECT_EQ(box.asked, (Asked{7, 0}));
  after.ask(HandAction::ToggleFree);
  for (int i = 0; i < 9; ++i) sut.hear(after.next());
  EXPECT_EQ(box.asked, (Asked{8, 0}));
}

TEST(ProbeInWorld, CountsOnAfter255) {
  AskingHand hand(1);
  FakeBox box(0.015);
  ProbeInWorld sut(box);
  ASSERT_TRUE(sut.open(hand.next()));
  for (unsigned i = 1; i <= 600; ++i) {
    hand.ask(HandAction::Reset);
    sut.hear(hand.next());
    ASSERT_EQ(box.asked, (Asked{0, i}));
  }
}

TEST(ProbeInWorld, AsksForOneOfEachAtATimeWhateverIsSaid) {
  FakeBox box(0.015);
  ProbeInWorld sut(box);
  ASSERT_TRUE(sut.open(sample(1, {})));
  HandSample hostile = sample(2, {});
  hostile.has_actions = true;
  hostile.actions.fill(255);
  sut.hear(hostile);
  EXPECT_EQ(box.asked, (Asked{1, 1}));
  hostile.has_actions = false;  // and no more of it
  for (int i = 0; i < 300; ++i) sut.hear(hostile);
  EXPECT_EQ(box.asked, (Asked{1, 1}));
}

TEST(ProbeInWorld, AsksAgainWhileTheWorldHasNoRoomForIt) {
  AskingHand hand(1);
  FakeBox box(0.015);
  ProbeInWorld sut(box);
  ASSERT_TRUE(sut.open(hand.next()));
  hand.ask(HandAction::ToggleFree);
  box.has_room = false;
  for (int i = 0; i < 5; ++i) sut.hear(hand.next());
  EXPECT_EQ(box.asked, (Asked{}));
  box.has_room = true;
  for (int i = 0; i < 5; ++i) sut.hear(hand.next());
  EXPECT_EQ(box.asked, (Asked{1, 0}));
}

}  // namespace
}  // namespace thimble::coupling
