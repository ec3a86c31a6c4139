#include "tests/campaign/campaign.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "sim/model/arm/register_arm_models.hpp"
#include "tests/campaign/planted_breach.hpp"
#include "tests/campaign/report.hpp"
#include "tests/campaign/shrink.hpp"
#include "tests/campaign/tapped_arm.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr std::uint64_t kShort = 60'000;  // ticks: some two episodes

TEST(Programme, IsTheSameForTheSameSeedAndAnotherForAnother) {
  EXPECT_EQ(to_text(draw(1, 2)), to_text(draw(1, 2)));
  EXPECT_NE(to_text(draw(1, 2)), to_text(draw(1, 3)));
  EXPECT_NE(to_text(draw(1, 2)), to_text(draw(2, 2)));
}

TEST(Programme, HundredOfThemHaveEveryKindOfEvent) {
  std::array<int, kEventKindCount> seen{};
  for (std::uint64_t episode = 0; episode < 100; ++episode) {
    for (const Event& event : draw(1, episode).events) ++seen[static_cast<std::size_t>(event.kind)];
  }
  for (std::size_t kind = 0; kind < kEventKindCount; ++kind) {
    EXPECT_GT(seen[kind], 20) << to_string(static_cast<EventKind>(kind));
  }
}

// Its firmware goes with its power, and with a handle that died nothing but the handle.
TEST(Episode, AFalconThatWasLostIsLoadedAndDrivenAgain) {
  for (const EventKind kind : {EventKind::Unplug, EventKind::Disconnect}) {
    Programme programme;
    programme.ticks = 20'000;
    programme.setup.device = "sim:falcon-loaded";
    programme.events.push_back({kind, std::chrono::seconds(6), std::chrono::milliseconds(100)});
    for (int second = 7; second < 20; ++second) {
      programme.events.push_back({EventKind::Clear, std::chrono::seconds(second)});
    }
    const Ending ending = play(programme);
    EXPECT_FALSE(ending.breach) << to_text(*ending.breach);
    EXPECT_EQ(ending.tally.recoveries_on_usb, 1U) << to_string(kind);
    EXPECT_GT(ending.tally.judged.ticks_due_on_usb, 5000U);
  }
}

TEST(Episode, PlayedTwiceIsTheSameToTheLastBit) {
  const Programme programme = draw(3, 4);
  const Ending first = play(programme);
  const Ending second = play(programme);
  EXPECT_EQ(first.trace, second.trace);
  EXPECT_EQ(first.tally.ticks, programme.ticks);
  EXPECT_EQ(to_text(first.tally), to_text(second.tally));
  EXPECT_NE(play(draw(3, 5)).trace, first.trace);
}

TEST(Campaign, IsTheSameHoweverManyPlayIt) {
  const Outcome alone = run({.ticks = kShort, .seed = 7, .jobs = 1});
  const Outcome together = run({.ticks = kShort, .seed = 7, .jobs = 2});
  EXPECT_EQ(alone.trace, together.trace);
  EXPECT_EQ(alone.tally.ticks, kShort);
  EXPECT_EQ(to_text(alone.tally), to_text(together.tally));
  EXPECT_FALSE(alone.failure.has_value());
}

// A programme in which something happens to an arm that leans on a wall.
Programme leaning() {
  Programme programme;
  programme.seed = 1;
  programme.ticks = 6000;
  programme.setup.motion = "poke";
  programme.setup.hand_reach_m = 0.03;
  return programme;
}

TEST(Episode, APlugThatIsPulledAndPutBackWhileTheServoSleepsCostsTheBoardItsStart) {
  Programme programme = leaning();
  programme.events = {{EventKind::Unplug, milliseconds(2000), milliseconds(707)},
                      {EventKind::LateServo, milliseconds(3240), milliseconds(25)},
                      {EventKind::Unplug, milliseconds(3244), milliseconds(9)}};
  const Ending ending = play(programme);
  EXPECT_FALSE(ending.breach.has_value()) << to_text(*ending.breach);
  EXPECT_EQ(ending.tally.unplugged, 2U);
}

// A board beside which something stands that changes what it is sent.
class ArmBehind : public plugin::SimHidModel {
 public:
  explicit ArmBehind(std::unique_ptr<plugin::SimHidModel> below) : below_(std::move(below)) {}
  [[nodiscard]] bus::BusDeviceInfo describe() const override { return below_->describe(); }
  [[nodiscard]] Duration frame_period() const noexcept override { return below_->frame_period(); }
  void advance(MonotonicTime t) noexcept override { below_->advance(t); }
  std::size_t in_report(std::span<std::uint8_t> out) noexcept override {
    return below_->in_report(out);
  }
  void power_cycle() noexcept override { below_->power_cycle(); }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override {
    return below_->arm_backend();
  }

 protected:
  std::unique_ptr<plugin::SimHidModel> below_;
};

// Between the wire and the tap: doubles every current, as a wrong full scale would.
class DoublingArm final : public ArmBehind {
 public:
  using ArmBehind::ArmBehind;
  void out_report(std::span<const std::uint8_t> bytes) noexcept override {
    std::array<std::uint8_t, bus::kMaxHidReportBytes> doubled{};
    std::copy(bytes.begin(), bytes.end(), doubled.begin());
    for (std::size_t motor = 0; motor < 3; ++motor) {
      const int low = bytes[2 * motor];
      const int high = static_cast<std::int8_t>(bytes[2 * motor + 1]);
      const int twice = 2 * (256 * high + low);
      doubled[2 * motor] = static_cast<std::uint8_t>(twice & 0xff);
      doubled[2 * motor + 1] = static_cast<std::uint8_t>((twice >> 8) & 0xff);
    }
    below_->out_report({doubled.data(), bytes.size()});
  }
};

// Behind the tap: takes short reports for what they were, as if a buffer kept their end.
class ObeyingArm final : public ArmBehind {
 public:
  using ArmBehind::ArmBehind;
  void out_report(std::span<const std::uint8_t> bytes) noexcept override {
    if (bytes.size() == kept_.size()) std::copy(bytes.begin(), bytes.end(), kept_.begin());
    below_->out_report(kept_);
  }

 private:
  std::array<std::uint8_t, 14> kept_{};
};

Planted planted_arm(
    Result<std::unique_ptr<plugin::SimHidModel>> (*create)(const plugin::SimModelSettings&)) {
  Planted planted;
  planted.models.push_back({"phantom-vintage", "not as it should be", create});
  return planted;
}

Planted doubling() {
  return planted_arm(
      [](const plugin::SimModelSettings& settings) -> Result<std::unique_ptr<plugin::SimHidModel>> {
        auto below = tapped_arms().front().create_hid(settings);
        if (!below) return below;
        return std::make_unique<DoublingArm>(*std::move(below));
      });
}

Planted obeying() {
  return planted_arm(
      [](const plugin::SimModelSettings& settings) -> Result<std::unique_ptr<plugin::SimHidModel>> {
        plugin::SimModelRegistry models;
        sim::register_arm_models(models);
        auto below = models.entries().front().create_hid(settings);
        if (!below) return below;
        return std::make_unique<TappedArm>(std::make_unique<ObeyingArm>(*std::move(below)));
      });
}

// For 700 ms an arm that leans on a wall gets nothing but the beginnings of reports, and no stop.
TEST(Episode, AnArmThatHearsShortReportsOnlyIsStoppedByItsWatchdog) {
  Programme programme = leaning();
  programme.events.push_back({EventKind::TruncateOut, milliseconds(3400), milliseconds(700)});
  programme.events.push_back({EventKind::Estop, milliseconds(3450), milliseconds(20)});
  const Ending ending = play(programme);
  EXPECT_FALSE(ending.breach.has_value()) << to_text(*ending.breach);
  EXPECT_GT(ending.tally.reports.of(sim::FaultKind::TruncateOut), 100U);
  const Ending obeyed = play(programme, obeying());
  ASSERT_TRUE(obeyed.breach.has_value());
  EXPECT_THAT(obeyed.breach->rule, HasSubstr("current of a motor after a stop"));
}

TEST(Episode, WhatIsWrittenBeforeAStopAndComesLateIsFollowedByTheZero) {
  Programme programme = leaning();
  programme.ticks = 9000;
  for (int ms = 2500; ms < 9000; ms += 1000) {
    programme.events.push_back({EventKind::DelayOut, milliseconds(ms), milliseconds(15)});
    programme.events.push_back({EventKind::Estop, milliseconds(ms + 10), milliseconds(20)});
    programme.events.push_back({EventKind::Clear, milliseconds(ms + 100)});
  }
  const Ending ending = play(programme);
  EXPECT_FALSE(ending.breach.has_value()) << to_text(*ending.breach);
  EXPECT_GT(ending.tally.reports.of(sim::FaultKind::DelayOut), 50U);
  EXPECT_GT(ending.tally.recoveries, 3U);
}

TEST(Episode, FindsAnArmThatIsAskedForTwiceTheForce) {
  Programme programme = leaning();
  programme.setup.force_newton = 1;
  EXPECT_FALSE(play(programme).breach.has_value());
  const Ending ending = play(programme, doubling());
  ASSERT_TRUE(ending.breach.has_value());
  EXPECT_THAT(ending.breach->rule, HasSubstr("norm of the force at the arm"));
  EXPECT_EQ(play(programme, doubling()).breach->tick, ending.breach->tick);
}

TEST(Campaign, NamesTheEpisodeThatBroke) {
  const Planted planted = planted_breach();
  const Order order{.ticks = 1'000'000, .seed = 1, .jobs = 2};
  const Outcome outcome = run(order, planted);
  ASSERT_TRUE(outcome.failure.has_value());
  const Failure& failure = *outcome.failure;

  const Ending again = play(programme_of(order, failure.episode), planted);
  ASSERT_TRUE(again.breach.has_value());
  EXPECT_EQ(again.breach->tick, failure.ending.breach->tick);
  EXPECT_EQ(again.trace, failure.ending.trace);

  const auto shrunk =
      shrink(failure.programme, [&](const Programme& one) { return play(one, planted).breach; });
  ASSERT_TRUE(shrunk.has_value());
  ASSERT_EQ(shrunk->programme.events.size(), 1U) << to_text(shrunk->programme);
  EXPECT_EQ(shrunk->programme.events.front().kind, EventKind::Estop);
  EXPECT_EQ(shrunk->programme.setup, campaign::Setup{})
      << "the configuration has nothing to do with it";
}

}  // namespace
}  // namespace thimble::campaign
