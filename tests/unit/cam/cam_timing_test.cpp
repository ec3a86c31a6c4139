#include <gtest/gtest.h>

#include "tests/unit/cam/cam_bench.hpp"

// Clocks of whole scans, as they come out of step lists: the table of what eight and fewer modules
// took, from the figures of MIT's software (docs/cambus.md, section 5).
namespace thimble::cambus {
namespace {

using test::CamBench;
using test::Layout;

std::uint64_t scan_clocks(const Layout& layout) {
  CamBench bench(layout, 22);
  CamProgram program(bench.space());
  program.run();
  program.delay(1);
  const auto before = bench.machine().now_clocks();
  bench.play(program);
  // The write of `run`: idle 8, number 1, direction 1, data 6, parity 1, a hop 1; and the delay.
  const std::uint64_t frame = 18 + 1;
  EXPECT_EQ(bench.machine().now_clocks() - before, frame);
  EXPECT_TRUE(bench.machine().is_scanning());
  bench.machine().wait_for_scan();
  return bench.machine().now_clocks() - before - 18;
}

TEST(CamTiming, SweepsOf512SitesHaveTwoRefreshesEach) {
  const std::uint64_t sweep = 512 + 40 + 2 * 4;
  EXPECT_EQ(scan_clocks({{1, 1, 1}, {9, 9, 0}, Division::StripY}), 64 * sweep);  // 1.434 ms
  EXPECT_EQ(scan_clocks({{1, 1, 0}, {9, 9, 0}, Division::StripY}), 128 * sweep);
}

TEST(CamTiming, SweepsOf64SitesHaveARefreshEveryThird) {
  const std::uint64_t sweep = 64 + 40;
  EXPECT_EQ(scan_clocks({{1, 1, 1}, {6, 6, 6}, Division::StripY}), 512 * sweep + 512 / 3 * 4);
}

TEST(CamTiming, AsManyModulesAsThereAreScanInTheTimeOfOne) {
  EXPECT_EQ(scan_clocks({{1, 1, 1}, {5, 6, 2}, Division::StripY}),
            scan_clocks({{0, 0, 0}, {5, 3, 2}, Division::Mesh}));
}

TEST(CamTiming, ATableTakesItsEntries) {
  CamBench bench({{0, 0, 0}, {3, 3, 0}, Division::Mesh});
  CamProgram program(bench.space());
  std::mt19937 random(1);
  program.load_table(test::random_cells(kTableEntries, 0xffff, random));
  const auto before = bench.machine().now_clocks();
  bench.play(program);
  // Frames of lut-index (number 11: 4 bits) and lut-io (13: 4 bits).
  EXPECT_EQ(bench.machine().now_clocks() - before, (15 + 16) + (15 + 65536));
}

TEST(CamTiming, WhatWaitsWaitsForTheScanAndAReadOfCountsDoesNot) {
  CamBench bench({{0, 0, 0}, {5, 5, 0}, Division::Mesh});
  CamProgram counts(bench.space());
  counts.run();
  counts.run({.is_scan = false, .takes_counts = true});
  counts.run();
  static_cast<void>(counts.read_counts());
  bench.play(counts);
  EXPECT_TRUE(bench.machine().is_scanning());
  CamProgram kick(bench.space());
  ASSERT_TRUE(kick.kick({}));
  bench.play(kick);
  EXPECT_FALSE(bench.machine().is_scanning());
  EXPECT_EQ(bench.machine().counters().scans, 2U);
}

}  // namespace
}  // namespace thimble::cambus
