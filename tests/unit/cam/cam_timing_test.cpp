#include <gtest/gtest.h>

#include "tests/unit/cam/cam_bench.hpp"

// Clocks of whole scans, as they come out of step lists: the table of what eight and fewer modules
// took, from the figures of MIT's software (docs/cambus.md, section 5).
namespace thimble::cambus {
namespace {

using test::CamBench;
using test::Layout;

// Sets sweeps as long as the DRAM allows (docs/cambus.md, section 5).
StepList by_rows(const CamSpace& space) {
  const auto sweep = static_cast<std::uint32_t>(std::min(12, space.log2_sector_sites()));
  const std::uint32_t clocks = (1U << sweep) + 40;
  StepListBuilder builder;
  builder.write(space.scan_format(space.whole())
                    .set(field::kEndOfSweep, sweep)
                    .set(field::kSweepsBetweenRefresh, std::max(1U, 390 / clocks))
                    .set(field::kRefreshLength, std::min(31U, clocks / 390 + 1)));
  return builder.finish();
}

std::uint64_t scan_clocks(const Layout& layout, bool is_by_rows = false) {
  CamBench bench(layout, 22);
  if (is_by_rows) bench.play(by_rows(bench.space()));
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

// Of the public figures (docs/cambus.md, section 5; those at 25 and 20 MHz were worked out by hand
// from them, to hundredths): milliseconds of a scan.
struct KnownScan {
  Layout layout;
  bool is_by_rows;  // sweeps of a whole row of the DRAM, whatever the space's own rows are
  double at_25_mhz_ms;
  double at_20_mhz_ms;
};
void PrintTo(const KnownScan& known, std::ostream* out) {
  *out << to_string(known.layout) << (known.is_by_rows ? " by rows" : "");
}

class CamTimingTable : public testing::TestWithParam<KnownScan> {};
INSTANTIATE_TEST_SUITE_P(
    Scans, CamTimingTable,
    testing::Values(KnownScan{{{0, 0, 0}, {9, 9, 0}, Division::StripY}, false, 11.47, 14.34},
                    KnownScan{{{1, 0, 0}, {9, 9, 0}, Division::StripY}, false, 5.73, 7.17},
                    KnownScan{{{1, 1, 0}, {9, 9, 0}, Division::StripY}, false, 2.87, 3.58},
                    KnownScan{{{1, 1, 1}, {9, 9, 0}, Division::StripY}, false, 1.43, 1.79},
                    KnownScan{{{1, 1, 0}, {6, 6, 6}, Division::StripY}, false, 4.31, 5.39},
                    KnownScan{{{1, 1, 1}, {6, 6, 6}, Division::StripY}, false, 2.16, 2.70},
                    KnownScan{{{1, 1, 1}, {9, 9, 0}, Division::StripY}, true, 1.34, 1.67}));

TEST_P(CamTimingTable, TakesItsTimeAtEachClock) {
  const KnownScan& known = GetParam();
  const auto clocks = static_cast<double>(scan_clocks(known.layout, known.is_by_rows));
  constexpr double kRounded_ms = 0.0051;
  EXPECT_NEAR(clocks / 25e3, known.at_25_mhz_ms, kRounded_ms);
  EXPECT_NEAR(clocks / 20e3, known.at_20_mhz_ms, kRounded_ms);
  EXPECT_NEAR(clocks / 21e3, known.at_25_mhz_ms * 25 / 21, kRounded_ms * 25 / 21);
}

// Which sites a sweep has is nobody's business but the clock's.
TEST(CamTiming, SweepsOfAWholeRowComeToTheSameCells) {
  const Layout layout{{1, 1, 1}, {9, 5, 0}, Division::StripY};
  std::mt19937 random(6);
  const auto cells = test::random_cells(std::size_t{1} << 14, 0xffff, random);
  std::vector<test::Cells> after;
  for (const bool is_by_rows : {false, true}) {
    CamBench bench(layout, 22);
    bench.put(cells);
    bench.load([](std::uint32_t cell) { return (cell << 3 | cell >> 13) ^ 0x5a5aU; });
    if (is_by_rows) bench.play(by_rows(bench.space()));
    bench.step({{layers(0, 4), {3, -1, 0}}, {layers(5, 15), {-7, 2, 0}}}, 3);
    after.push_back(bench.get());
  }
  EXPECT_EQ(after[0], after[1]);
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

TEST(CamTiming, ABlockTakesWhatItsSpaceSays) {
  CamBench bench({{1, 1, 0}, {7, 6, 3}, Division::StripY}, 22);
  for (const ScanBlock& block : {bench.space().whole(), ScanBlock{{32, 8, 0}, {5, 3, 2}},
                                 ScanBlock{{3, 4, 5}, {0, 2, 0}}, ScanBlock{{1, 1, 1}, {}}}) {
    CamProgram program(bench.space());
    program.scan_within(block);
    program.run();
    program.delay(1);
    bench.play(program);
    const auto begun = bench.machine().now_clocks() - 1;  // when the frame of `run` was over
    bench.machine().wait_for_scan();
    EXPECT_EQ(bench.machine().now_clocks() - begun, bench.space().clocks_of(block));
  }
}

TEST(CamTiming, AsManyModulesAsThereAreScanInTheTimeOfOne) {
  EXPECT_EQ(scan_clocks({{1, 1, 1}, {5, 6, 2}, Division::StripY}),
            scan_clocks({{0, 0, 0}, {5, 3, 2}, Division::Mesh}));
}

// The largest there is; its bits are not moved, which would take a second.
TEST(CamTiming, AModuleOf16MillionSitesScansRowByRow) {
  CamBench bench({{0, 0, 0}, {13, 11, 0}, Division::Mesh}, 24);
  bench.machine().keep_only_time();
  CamProgram program(bench.space());
  program.run();
  bench.play(program);
  const auto before = bench.machine().now_clocks();
  bench.machine().wait_for_scan();
  constexpr std::uint64_t kRow = 8192 + 40 + 22 * 4;
  EXPECT_EQ(bench.machine().now_clocks() - before, 2048 * kRow);
  EXPECT_EQ(bench.machine().counters().scans, 1U);
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
