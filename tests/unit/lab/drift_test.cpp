#include "lab/drift/drift.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lab/drift/taps.hpp"

namespace thimble::lab {
namespace {

Taps taps_of(const CouplingCase& of, double delay_s, double taps_per_s) {
  const auto taps = run_taps({.of = of, .delay_s = delay_s, .taps_per_s = taps_per_s, .taps = 30});
  EXPECT_TRUE(taps) << taps.error().message;
  return taps.value_or(Taps{});
}

// teleop.md 2(e), "Drift": bounded below 1.2 taps/s at 100 ms, 2.5 at 50, 0.6 at 200.
TEST(TapTheory, BeginsWhereTheFactsArithmeticSays) {
  EXPECT_NEAR(tap_theory(0.1, 1, link::SendMode::Streamed).critical_per_s, 1.2, 0.1);
  EXPECT_NEAR(tap_theory(0.05, 1, link::SendMode::Streamed).critical_per_s, 2.5, 0.2);
  EXPECT_NEAR(tap_theory(0.2, 1, link::SendMode::Streamed).critical_per_s, 0.6, 0.05);
}

TEST(TapTheory, DriftsJustBeyondWhereItBeginsAndNotBefore) {
  for (const double delay_s : {0.02, 0.1, 0.3}) {
    for (const link::SendMode mode : {link::SendMode::Streamed, link::SendMode::LockStep}) {
      const double critical = tap_theory(delay_s, 1, mode).critical_per_s;
      EXPECT_EQ(tap_theory(delay_s, 0.999 * critical, mode).drift_m_per_s, 0);
      EXPECT_GT(tap_theory(delay_s, 1.001 * critical, mode).drift_m_per_s, 0);
    }
  }
}

TEST(TapRuns, RareTapsFindTheFrameReturned) {
  const Taps taps = taps_of({.name = "ghost-point"}, 0.1, 0.5);
  ASSERT_EQ(taps.offsets_m.size(), 30U);
  for (const double offset_m : taps.offsets_m) EXPECT_NEAR(offset_m, 0.0195, 0.0005);
  EXPECT_NEAR(taps.taps_per_s, 0.5, 0.01);
  EXPECT_LT(std::abs(drift_m_per_s(taps)), 1e-5);
}

TEST(TapRuns, QuickOnesDriveTheFrameAwayAsFastAsTheySay) {
  const Taps taps = taps_of({.name = "ghost-point"}, 0.1, 2);
  const TapTheory theory = tap_theory(0.1, taps.taps_per_s, link::SendMode::Streamed);
  EXPECT_GT(theory.drift_m_per_s, 0.01);
  EXPECT_NEAR(drift_m_per_s(taps), theory.drift_m_per_s, 0.1 * theory.drift_m_per_s);
}

TEST(TapRuns, WallsThatRecoverDisplaceNothingAndGiveTheHandEnergy) {
  CouplingCase recovery{.name = "recovery", .scheme = coupling::Scheme::ConstraintPlane};
  recovery.settings.constraint_plane.late_walls = coupling::LateWalls::Recovery;
  const Taps taps = taps_of(recovery, 0.1, 1);
  for (const double offset_m : taps.offsets_m) EXPECT_EQ(offset_m, 0);
  EXPECT_GT(taps.generated_joule, taps_of({.name = "ghost-point"}, 0.1, 1).generated_joule);
}

TEST(TapRuns, AWallThatIsKnownBeforehandDisplacesNothingHoweverQuickTheTaps) {
  const Taps taps = taps_of({.name = "composite", .scheme = coupling::Scheme::Composite}, 0.2, 4);
  ASSERT_EQ(taps.offsets_m.size(), 30U);
  for (const double offset_m : taps.offsets_m) EXPECT_EQ(offset_m, 0);
  EXPECT_NEAR(taps.taps_per_s, 4, 0.01);
}

TEST(TapRuns, DriftOfALineIsItsSlope) {
  Taps line;
  line.taps_per_s = 2;
  for (int i = 0; i < 20; ++i) line.offsets_m.push_back(0.01 + 0.003 * i);
  EXPECT_NEAR(drift_m_per_s(line), 0.006, 1e-12);
  EXPECT_EQ(drift_m_per_s({}), 0);
}

}  // namespace
}  // namespace thimble::lab
