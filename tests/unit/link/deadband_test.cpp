#include "daemon/link/deadband.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>

namespace thimble::link {
namespace {

using std::chrono::milliseconds;

constexpr double kBand_m = 0.0005;

MonotonicTime tick(int number) { return {milliseconds(1000 + number)}; }

coupling::HandSample at(double x_m, double v_m_per_s = 0) {
  return {.hand = {x_m, 0, 0}, .velocity = {v_m_per_s, 0, 0}};
}

TEST(DeadbandTest, WithoutOneEverythingIsSent) {
  Deadband sut(0);
  sut.on_sent(at(0), tick(0));
  EXPECT_FALSE(sut.may_skip(at(0), tick(1), milliseconds(50)));
}

TEST(DeadbandTest, SkipsWhatIsNearAndNothingElse) {
  Deadband sut(kBand_m);
  const Duration answer = milliseconds(50);
  EXPECT_FALSE(sut.may_skip(at(0), tick(0), answer)) << "nothing was told yet";
  sut.on_sent(at(0, 0.1), tick(0));
  EXPECT_TRUE(sut.may_skip(at(0.0005, 0.1), tick(1), answer));
  EXPECT_FALSE(sut.may_skip(at(0.00051, 0.1), tick(1), answer));
  EXPECT_FALSE(sut.may_skip(at(-0.00051, 0.1), tick(1), answer));
  EXPECT_TRUE(sut.may_skip(at(0, 0.1199), tick(1), answer)) << "what an encoder's step looks like";
  EXPECT_FALSE(sut.may_skip(at(0, 0.121), tick(1), answer));
  EXPECT_FALSE(sut.may_skip(at(std::nan("")), tick(1), answer));
  for (const auto& spoil : {+[](coupling::HandSample& s) { s.buttons = 1; },
                            +[](coupling::HandSample& s) { s.restart = 1; },
                            +[](coupling::HandSample& s) { s.tool.stiffness = {1}; }}) {
    coupling::HandSample other = at(0, 0.1);
    spoil(other);
    EXPECT_FALSE(sut.may_skip(other, tick(1), answer));
  }
  sut.on_sent(at(0, 0.5), tick(1));
  EXPECT_TRUE(sut.may_skip(at(0, 0.5499), tick(2), answer));
  EXPECT_FALSE(sut.may_skip(at(0, 0.551), tick(2), answer));
}

// A press and its release may both lie between two samples: the count alone tells of it.
TEST(DeadbandTest, APressIsToldAtOnceThoughItsButtonIsUpAgain) {
  const Duration answer = milliseconds(50);
  for (const std::size_t button : {0U, 7U}) {
    Deadband sut(kBand_m);
    coupling::HandSample before = at(0);
    before.has_presses = true;
    before.presses[button] = 255;
    sut.on_sent(before, tick(0));
    EXPECT_TRUE(sut.may_skip(before, tick(1), answer)) << "that press was told";
    coupling::HandSample pressed = before;
    pressed.presses[button] = 0;  // modulo 256
    EXPECT_FALSE(sut.may_skip(pressed, tick(1), answer)) << button;
    sut.on_sent(pressed, tick(1));
    EXPECT_TRUE(sut.may_skip(pressed, tick(2), answer)) << button;
  }
}

TEST(DeadbandTest, WhatIsAskedOfTheWorldIsToldAtOnce) {
  const Duration answer = milliseconds(50);
  for (const std::size_t action : {0U, 1U}) {
    Deadband sut(kBand_m);
    coupling::HandSample before = at(0);
    before.has_actions = true;
    before.actions[action] = 255;
    sut.on_sent(before, tick(0));
    EXPECT_TRUE(sut.may_skip(before, tick(1), answer)) << "that was told";
    coupling::HandSample asked = before;
    asked.actions[action] = 0;  // modulo 256
    EXPECT_FALSE(sut.may_skip(asked, tick(1), answer)) << action;
  }
}

TEST(DeadbandTest, ARestingHandIsStillToldNowAndThen) {
  Deadband sut(kBand_m);
  int sent = 0;
  for (int i = 0; i < 1000; ++i) {
    if (sut.may_skip(at(0), tick(i), milliseconds(50))) continue;
    sut.on_sent(at(0), tick(i));
    sut.on_answered({}, tick(i));
    ++sent;
  }
  EXPECT_EQ(sent, 200);
}

TEST(DeadbandTest, AnAnswerThatIsOverdueIsNotWaitedFor) {
  Deadband sut(kBand_m);
  sut.on_sent(at(0), tick(0));
  sut.on_answered({}, tick(0));
  sut.on_sent(at(0.0006), tick(1));
  EXPECT_TRUE(sut.may_skip(at(0.0006), tick(2), milliseconds(2)));
  EXPECT_FALSE(sut.may_skip(at(0.0006), tick(4), milliseconds(2))) << "lost, for all one knows";
  EXPECT_TRUE(sut.may_skip(at(0.0004), tick(4), milliseconds(2))) << "near whatever is known there";
  sut.on_answered({0.0006, 0, 0}, tick(1));
  EXPECT_TRUE(sut.may_skip(at(0.0006), tick(4), milliseconds(2)));
}

// A hand that swings as the lab's does, over a network that loses: what the other side holds is
// never further from the hand than the band, and what the hand moves while it may not know better.
TEST(DeadbandTest, TheOtherSideIsNeverFurtherOffThanItSays) {
  for (const double loss : {0.0, 0.05, 0.3}) {
    std::mt19937 random(static_cast<unsigned>(100 * loss));
    std::bernoulli_distribution is_lost(loss);
    Deadband sut(kBand_m);
    struct Flight {
      int arrives{};
      int sent{};
      double x_m{};
    };
    std::deque<Flight> flying;
    std::deque<Flight> answers;
    double held_m = 0;
    int sent = 0;
    double most_m = 0;
    constexpr int kOneWay = 5;
    constexpr double kAmplitude_m = 0.045;
    constexpr double kOmega = 4;  // 0.18 m/s at most
    for (int i = 0; i < 20000; ++i) {
      const double x_m = kAmplitude_m * std::sin(kOmega * 1e-3 * i);
      const coupling::HandSample sample =
          at(x_m, kAmplitude_m * kOmega * std::cos(kOmega * 1e-3 * i));
      while (!answers.empty() && answers.front().arrives <= i) {
        sut.on_answered({answers.front().x_m, 0, 0}, tick(answers.front().sent));
        answers.pop_front();
      }
      if (!sut.may_skip(sample, tick(i), milliseconds(2 * kOneWay + 1))) {
        sut.on_sent(sample, tick(i));
        ++sent;
        if (!is_lost(random)) flying.push_back({i + kOneWay, i, x_m});
      }
      while (!flying.empty() && flying.front().arrives <= i) {
        held_m = flying.front().x_m;
        if (!is_lost(random)) answers.push_back({i + kOneWay, flying.front().sent, held_m});
        flying.pop_front();
      }
      if (i > 100) most_m = std::max(most_m, std::abs(held_m - x_m));
    }
    const double lag_m = kAmplitude_m * kOmega * 1e-3 * (kOneWay + 1);
    const double lost_m = loss == 0 ? 0 : kAmplitude_m * kOmega * 5e-3 * (loss < 0.1 ? 4 : 12);
    EXPECT_LE(most_m, kBand_m + lag_m + lost_m) << loss;
    EXPECT_LT(sent, 20000 / 2) << loss;  // at least half is saved
    RecordProperty("share_sent_" + std::to_string(static_cast<int>(100 * loss)),
                   std::to_string(sent / 20000.0));
  }
}

}  // namespace
}  // namespace thimble::link
