#include "lab/stability/stability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "lab/stability/stability_cases.hpp"
#include "lab/stability/theory.hpp"
#include "lab/trial/random.hpp"

namespace thimble::lab {
namespace {

constexpr double kServo_s = 1e-3;

// teleop.md 2(a): simulated there by other code, hand of 0.15 kg.
struct Simulated {
  double delay_s, soft, middle, hard;  // N/m for b = 2, 4, 8 N·s/m
};
constexpr Simulated kSimulated[] = {
    {0.001, 1361, 2732, 5502}, {0.005, 370, 748, 1529}, {0.02, 102, 211, 447},
    {0.05, 43, 93, 201},       {0.1, 23, 50, 109},      {0.2, 13, 27, 58},
};

TEST(StabilityTheory, TheLimitForAnyDelayIsThatOfTheFactsSimulation) {
  for (const Simulated& facts : kSimulated) {
    const auto limit = [&](double b) {
      return any_delay_limit(0.15, b, facts.delay_s, kServo_s).newton_per_m;
    };
    // They are rounded to whole numbers.
    EXPECT_NEAR(limit(2), facts.soft, 0.02 * facts.soft + 0.5) << facts.delay_s;
    EXPECT_NEAR(limit(4), facts.middle, 0.02 * facts.middle + 0.5) << facts.delay_s;
    EXPECT_NEAR(limit(8), facts.hard, 0.02 * facts.hard + 0.5) << facts.delay_s;
  }
}

TEST(StabilityTheory, TheLimitForAnyDelayIsARootOfItsEquation) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double m = random.uniform(0.05, 1);
    const double b = random.uniform(0.1, 20);
    const double delay_s = random.uniform(0, 1);
    const double late_s = delay_s + kServo_s / 2;
    const Crossing found = any_delay_limit(m, b, delay_s, kServo_s);
    const double omega = 2 * 3.14159265358979323846 * found.swing_hz;
    ASSERT_NEAR(found.newton_per_m * std::cos(omega * late_s), m * omega * omega,
                1e-6 * found.newton_per_m);
    ASSERT_NEAR(found.newton_per_m * std::sin(omega * late_s), b * omega,
                1e-6 * found.newton_per_m);
    ASSERT_GE(found.newton_per_m,
              short_delay_limit_newton_per_m(b, delay_s, kServo_s) * (1 - 1e-9));
  }
}

TEST(LargestStable, FindsWhereItEndsWithinOnePercent) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const double end = random.uniform(1, 1000);
    const auto found =
        largest_stable({0.3, 2000}, [&](double k) -> Result<bool> { return k <= end; });
    ASSERT_TRUE(found);
    ASSERT_NEAR(found->newton_per_m, end, 0.01 * end);
    ASSERT_FALSE(found->is_at_low || found->is_at_high);
  }
}

TEST(LargestStable, IsNotFooledByWhatIsStableAgainBeyond) {
  const auto found = largest_stable(
      {1, 1000}, [](double k) -> Result<bool> { return k < 20 || (k > 100 && k < 900); });
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->newton_per_m, 20, 0.2);
}

TEST(LargestStable, SaysWhereTheRangeEnds) {
  const auto all = largest_stable({1, 50}, [](double) -> Result<bool> { return true; });
  EXPECT_TRUE(all->is_at_high);
  EXPECT_EQ(all->newton_per_m, 50);
  const auto none = largest_stable({1, 50}, [](double) -> Result<bool> { return false; });
  EXPECT_TRUE(none->is_at_low);
  const auto failed = largest_stable(
      {1, 50}, [](double) -> Result<bool> { return fail(Errc::System, "no world"); });
  EXPECT_FALSE(failed);
}

bool is_stable(const std::string& name, double newton_per_m, double delay_s) {
  for (const StabilityCase& one : stability_cases()) {
    if (one.name != name) continue;
    const auto found = one.is_stable(newton_per_m, delay_s);
    EXPECT_TRUE(found) << found.error().message;
    return found.value_or(false);
  }
  ADD_FAILURE() << "no such case: " << name;
  return false;
}

// The thesis's wall at the delay of its Ethernet, thesis 3.2.
TEST(StabilityTrial, TheThesissWallSwingsFromTwoMillisecondsOnWhereItIsComputedFarAway) {
  EXPECT_TRUE(is_stable("remote-force", 800, 0.001));
  EXPECT_FALSE(is_stable("remote-force", 800, 0.003));
}

TEST(StabilityTrial, EachSchemeSwingsBeyondItsOwnLimitOnly) {
  for (const double delay_s : {0.01, 0.1}) {
    EXPECT_TRUE(is_stable("ghost-point", 3800, delay_s));
    EXPECT_FALSE(is_stable("ghost-point", 4300, delay_s));
    EXPECT_TRUE(is_stable("composite", 3800, delay_s));
    EXPECT_FALSE(is_stable("composite", 4300, delay_s));
    EXPECT_TRUE(is_stable("constraint-plane", 3800, delay_s));
    EXPECT_FALSE(is_stable("constraint-plane", 4300, delay_s));
    EXPECT_TRUE(is_stable("wave, b = 10", 3000, delay_s));
  }
  // Beyond, at long delays, one that leans may be stable again.
  const double sufficient = world_end_limit_newton_per_m(5, 0.01, kServo_s);
  EXPECT_TRUE(is_stable("spring-damper", 0.95 * sufficient, 0.01));
  EXPECT_FALSE(is_stable("spring-damper", 1.3 * sufficient, 0.01));
}

TEST(StabilityTrial, AWaveGivesTheHandNothing) {
  for (const double delay_s : {0.005, 0.2}) {
    Release how{.of = {.name = "wave", .scheme = coupling::Scheme::Wave}, .delay_s = delay_s};
    const auto found = let_go(how);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_TRUE(found->is_stable);
    // Of the wall's spring, which the push has loaded: 0.005 N over 1 mm.
    EXPECT_LT(found->generated_joule, 5e-6);
    how.of = {.name = "remote-force", .scheme = coupling::Scheme::RemoteForce};
    const auto driven = let_go(how);
    ASSERT_TRUE(driven);
    EXPECT_FALSE(driven->is_stable);
    EXPECT_GT(driven->generated_joule, 5e-6);
  }
}

TEST(StabilityTrial, TheSameTwiceIsTheSame) {
  const StabilityCase of = stability_cases().front();
  const auto once = of.find_largest(0.01);
  const auto again = of.find_largest(0.01);
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->newton_per_m, again->newton_per_m);
  EXPECT_NEAR(once->newton_per_m, 195, 4);  // the facts' table
}

}  // namespace
}  // namespace thimble::lab
