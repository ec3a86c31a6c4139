// The chain behind an adapter that loses, delays and spoils what passes it.
#include <gtest/gtest.h>

#include <random>

#include "sim/fault/faulty_gpio.hpp"
#include "tests/unit/safety/safety_bench.hpp"

namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

sim::FaultPlan some_plan(std::mt19937& dice, unsigned seed) {
  sim::FaultPlan plan;
  plan.seed = seed;
  for (double* chance : {&plan.random.drop_in, &plan.random.corrupt_in, &plan.random.delay_in,
                         &plan.random.drop_out, &plan.random.corrupt_out, &plan.random.stall}) {
    if (dice() % 2 == 0) *chance = 0.001 * static_cast<double>(dice() % 200);
  }
  plan.random.max_delay = milliseconds(1 + dice() % 80);
  plan.random.stall_lasts = milliseconds(1 + dice() % 300);
  sim::ScriptedFault gone;
  gone.kind = sim::FaultKind::Disconnect;
  gone.from = MonotonicTime{std::chrono::seconds(1 + dice() % 120)};
  plan.script.push_back(gone);
  return plan;
}

// A contact that is open must have stopped everything when the chip has had the time to say so, or
// to be missed: kSilence, and a step. A reading that lies is followed by one that does not.
constexpr Duration kSeen = kSilence + milliseconds(100);

class BadAdapter : public testing::TestWithParam<unsigned>, protected SafetyBench {
 protected:
  void open_behind(const sim::FaultPlan& plan) {
    lines.reset();  // a line is taken once
    lines = std::make_unique<sim::FaultyGpio>(open(), 3, clock, plan);
    chain.restart_lines();
  }
  // Either contact is opened or closed now and then; somebody asks to go on all the time.
  void play(std::mt19937& dice) {
    if (dice() % 100 == 0) chip.set_level(dice() % 2, dice() % 2 == 0);
    if (dice() % 60 == 0) press(false);
    const bool is_open = chip.level(0) || chip.level(1);
    if (!is_open) open_since_ = clock.now();
    const std::uint32_t stops = chain.status().stops;
    const bool was_stopped = chain.status().is_stopped;
    step();
    const ChainStatus& status = chain.status();
    if (clock.now() - open_since_ > kSeen) {
      ASSERT_TRUE(status.is_stopped) << to_string(status.trouble);
      ++judged_;
    }
    ASSERT_TRUE(!was_stopped || status.is_stopped) << "nothing resumes by itself";
    ASSERT_TRUE(status.is_stopped || status.stops == stops);
    if (dice() % 20 == 0 && chain.reset()) ++resumed_;
  }
  MonotonicTime open_since_{};
  int judged_{0};
  int resumed_{0};
};

TEST_P(BadAdapter, NeverHidesAnOpenContactForLongAndNeverResumes) {
  std::mt19937 dice(GetParam());
  open_behind(some_plan(dice, GetParam()));
  for (int i = 0; i < 20'000 && !HasFatalFailure(); ++i) play(dice);
  EXPECT_GT(judged_, 100);
  EXPECT_GT(resumed_, 0);
}

INSTANTIATE_TEST_SUITE_P(Plans, BadAdapter, testing::Range(1U, 61U));

}  // namespace
}  // namespace thimble::safety
