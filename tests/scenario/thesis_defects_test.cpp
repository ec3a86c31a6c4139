#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "tests/support/arm_watch.hpp"
#include "tests/support/guided_hand.hpp"

// Defects of the printed programs (docs/thesis-defects.md) that only the whole loop can show.
namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

TEST(ThesisDefect, WhateverTheCallbackAsksForTheArmGetsNoKick) {
  ClosedLoop sut({"arm.coupling.scheme=thesis-literal", "arm.hand.motion=still"});
  sut.run_until_driven();
  test::GuidedHand hand(sut);
  ArmWatch watch(sut);
  double largest_wish_newton = 0;
  double largest_step_newton = 0;
  double before_newton = 0;
  hand.go({0.035, 0, 0}, [&] {
    watch.see();
    const double wish_newton = norm(sut.frame().wish);
    largest_step_newton = std::max(largest_step_newton, wish_newton - before_newton);
    before_newton = wish_newton;
    largest_wish_newton = std::max(largest_wish_newton, wish_newton);
  });
  EXPECT_GT(largest_wish_newton, sut.settings().limiter.max_force_newton) << "proves nothing else";
  EXPECT_LE(watch.peak_sent_newton(), sut.settings().limiter.max_force_newton);
  EXPECT_LE(watch.peak_rise(), 1000 * 1.001);
  EXPECT_EQ(watch.breach(), "");
}

// Between an arm and its link: remembers what was sent, and fails when it is told to.
class WatchedLink final : public coupling::ArmLink {
 public:
  struct Log {
    std::vector<coupling::HandSample> sent;
    bool has_failed{false};
  };
  WatchedLink(coupling::ArmLink& below, Log& log) : below_(below), log_(log) {}
  void send(const coupling::HandSample& sample) noexcept override {
    log_.sent.push_back(sample);
    if (!log_.has_failed) below_.send(sample);
  }
  bool receive(coupling::ConstraintSet& out) noexcept override {
    return !log_.has_failed && below_.receive(out);
  }
  // As a link tells an error: it is not up.
  [[nodiscard]] coupling::LinkQuality quality() const noexcept override {
    return log_.has_failed ? coupling::LinkQuality{} : below_.quality();
  }

 private:
  coupling::ArmLink& below_;
  Log& log_;
};

ClosedLoop::Setup watching(WatchedLink::Log& log) {
  ClosedLoop::Setup setup;
  setup.wrap_link = [&log](coupling::ArmLink& below) {
    return std::make_unique<WatchedLink>(below, log);
  };
  return setup;
}

TEST(ThesisDefect, NothingIsSentBeforeThereIsASample) {
  WatchedLink::Log log;
  ClosedLoop sut({"arm.hand.motion=still", "arm.activate=false"}, watching(log));
  ASSERT_TRUE(sut.run_until(5, [&] { return sut.frame().state == OperatingState::Inactive; }));
  test::GuidedHand hand(sut);
  hand.go({0.010, -0.005, 0.007});
  EXPECT_TRUE(log.sent.empty());
  sut.controls().want_active = true;
  ASSERT_TRUE(sut.run_until(1, [&] { return !log.sent.empty(); }));
  EXPECT_LT(norm(log.sent.front().hand - sut.truth().tip), 0.001) << "the hand, not the centre";
  EXPECT_GT(norm(log.sent.front().hand - Position3{}), 0.010);
}

TEST(ThesisDefect, NoWayOutOfTheLoopLeavesTheMotorsOn) {
  WatchedLink::Log log;
  const std::vector<std::pair<const char*, std::function<void(ClosedLoop&)>>> ways{
      {"given back", [](ClosedLoop& loop) { loop.controls().want_active = false; }},
      {"stopped", [](ClosedLoop& loop) { loop.controls().is_estop_healthy = false; }},
      {"world gone", [](ClosedLoop& loop) { loop.set_network_up(false); }},
      {"cable pulled", [](ClosedLoop& loop) { loop.unplug(); }},
      {"link reports an error", [&](ClosedLoop&) { log.has_failed = true; }},
  };
  for (const auto& [name, leave] : ways) {
    log = {};
    ClosedLoop sut({"arm.hand.motion=still"}, watching(log));
    sut.run_until_leaning();
    ArmWatch watch(sut);
    leave(sut);
    sut.run(0.6, [&] { watch.see(); });
    EXPECT_EQ(norm(sut.truth().motor_force), 0) << name;
    EXPECT_EQ(watch.breach(), "") << name;
  }
}

TEST(ThesisDefect, AHandThatStartsDeepInMatterIsNotKicked) {
  ClosedLoop sut({"arm.hand.motion=still", "arm.activate=false"});
  ASSERT_TRUE(sut.run_until(5, [&] { return sut.frame().state == OperatingState::Inactive; }));
  test::GuidedHand hand(sut);
  hand.go({0.030, 0, 0});
  ArmWatch watch(sut);
  double largest_newton = 0;
  sut.controls().want_active = true;
  sut.run(1.0, [&] {
    watch.see();
    largest_newton = std::max(largest_newton, norm(sut.frame().wish));
  });
  EXPECT_EQ(sut.frame().gain, 1);
  EXPECT_TRUE(sut.frame().is_in_contact) << "the nearest wall came to the finger";
  EXPECT_NEAR(norm(sut.frame().offset), 0.0145, 0.0005);
  EXPECT_LT(largest_newton, 1.5 * 800 * 0.0006);
  EXPECT_EQ(watch.breach(), "");
}

}  // namespace
}  // namespace thimble
