#include <gtest/gtest.h>

#include "tests/scenario/box_watch.hpp"

namespace thimble {
namespace {

TEST(LongRun, TenMinutesOfExploringBreakNothing) {
  test::ClosedLoop sut;
  test::BoxWatch watch(sut);
  sut.run(600, [&] { watch.see(); });
  const servo::ServoSnapshot& end = sut.snapshot();
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(watch.pulls(), 0);
  EXPECT_EQ(watch.arm().ticks(), 600'000U);
  EXPECT_EQ(end.frame.tick, 600'000U);
  EXPECT_EQ(end.frame.state, OperatingState::Active);
  EXPECT_EQ(end.faults, 0U);
  EXPECT_EQ(end.missed_exchanges, 0U);
  EXPECT_EQ(end.protocol_errors, 0U);
  EXPECT_EQ(end.overruns, 0U);
  EXPECT_GT(end.total_contacts, 1000U);
  EXPECT_LT(norm(end.frame.tip - sut.truth().tip), 1e-3) << "no count was lost";
}

}  // namespace
}  // namespace thimble
