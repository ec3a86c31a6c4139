#include "lab/cam_latency.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace thimble::lab {
namespace {

// On a small space: 8 sweeps of 64 sites a module.
using testing::ContainsRegex;
using testing::HasSubstr;
using world::cam::SearchKind;

CamLatencyCase eight_boards() {
  CamLatencyCase of = cam_latency_cases().at(1);
  of.log2_cells = {6, 6, 0};
  return of;
}

CamLatencyCase case_of(const std::string& name) {
  for (const CamLatencyCase& of : cam_latency_cases()) {
    if (of.name == name) return of;
  }
  ADD_FAILURE() << name;
  return {};
}

TEST(CamLatency, ALookTakesTwoScansAndWhatTheirSweepsTake) {
  const auto run = run_cam_latency(eight_boards(), {2, 0});
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->scans, 4U);
  EXPECT_EQ(run->lists, 4U);
  // 40 clocks each, and a refresh every third: docs/cambus.md, section 5.
  const std::uint64_t scans = 4 * (8 * (64 + 40) + 8 / 3 * 4);
  EXPECT_GE(run->clocks, scans);
  EXPECT_LE(run->clocks, scans + 2 * 3000) << "the frames of two looks, and the host's own";
  EXPECT_NEAR(run->time_s, static_cast<double>(run->clocks) / 25e6, 1e-6);
  EXPECT_DOUBLE_EQ(run->latency_s, run->time_s + run->picture_s + kNetwork_s);
  EXPECT_DOUBLE_EQ(run->offset_m, 0.2 * run->latency_s);
}

// 64 lines of a monitor of 525, 60 frames a second: half a frame's wait, on average.
TEST(CamLatency, APictureTakesItsLinesAndHalfAFrameOfWaiting) {
  for (const int clock_mhz : {20, 25}) {
    CamLatencyCase of = eight_boards();
    of.clock_mhz = clock_mhz;
    const auto run = run_cam_latency(of, {2, 0});
    ASSERT_TRUE(run) << run.error().message;
    const double frame_s = 525 * (clock_mhz == 25 ? 794 / 25e6 : 636 / 20e6);
    EXPECT_NEAR(run->picture_s, frame_s * 64 / 525 + frame_s / 2, 2e-4);
  }
  CamLatencyCase of = eight_boards();
  of.updates_per_picture = 7;
  const auto run = run_cam_latency(of, {2, 0});
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_DOUBLE_EQ(run->latency_s, run->time_s + run->picture_s / 7 + kNetwork_s);
}

TEST(CamLatency, AHostThatCostsCostsAPictureOnce) {
  const auto free = run_cam_latency(eight_boards(), {2, 0});
  const auto paid = run_cam_latency(eight_boards(), {2, 3e-4});
  ASSERT_TRUE(free && paid);
  // It may miss a frame that it would have had.
  EXPECT_NEAR(paid->picture_s, free->picture_s, 1.0 / 60 / kPictures + 3e-4);
}

TEST(CamLatency, AClockThatIsSlowerTakesAsManyClocksAndLonger) {
  for (const int clock_mhz : {20, 21}) {
    CamLatencyCase of = eight_boards();
    of.clock_mhz = clock_mhz;
    const auto run = run_cam_latency(of, {2, 0});
    const auto usual = run_cam_latency(eight_boards(), {2, 0});
    ASSERT_TRUE(run && usual);
    EXPECT_NEAR(run->time_s, static_cast<double>(run->clocks) / (1e6 * clock_mhz), 1e-6);
    // But for what the host takes to look.
    EXPECT_NEAR(static_cast<double>(run->clocks), static_cast<double>(usual->clocks), 300);
  }
}

// The list that shifts is over when its scan has begun: as long as that takes, a host costs
// nothing.
TEST(CamLatency, TheHostsCostIsHiddenBehindAScanWhereOneRuns) {
  CamLatencyCase of = eight_boards();
  const auto probe = probe_cam_latency(of);
  ASSERT_TRUE(probe) << probe.error().message;
  const double lists_s = 2 * CamLatencyProbe::kCells * CamLatencyProbe::kHost_s;
  EXPECT_LT(probe->paid_s - probe->free_s, 0.9 * lists_s);
  EXPECT_GT(probe->paid_s - probe->free_s, 0.45 * lists_s);
}

TEST(CamLatency, CountingInTheSameScanSavesHalfOfThem) {
  CamLatencyCase once = eight_boards();
  once.counts_apart = false;
  const auto run = run_cam_latency(once, {2, 0});
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->scans, 2U);
  EXPECT_EQ(run->lists, 2U);
}

TEST(CamLatency, ATrailTakesFewerScansAndListsThanLeaps) {
  const auto leaps = run_cam_latency(case_of("8 boards, leap, one scan a look"), {34, 0});
  const auto trail = run_cam_latency(case_of("8 boards, trail"), {34, 0});
  ASSERT_TRUE(leaps && trail);
  EXPECT_LT(trail->scans, leaps->scans);
  EXPECT_LT(trail->lists, leaps->lists);
  const std::uint64_t scan = 64 * (512 + 40 + 2 * 4);
  EXPECT_LT(trail->clocks, trail->scans * scan) << "its table is on the board";
}

TEST(CamLatency, WhereCellsAreWiderTheSameWayOfTheHandIsFewerOfThem) {
  CamLatencyCase of = eight_boards();
  of.cell_width = 8;
  const auto run = run_cam_latency(of, {34, 0});
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->cells, 5);
  EXPECT_EQ(run->scans, 2U * 5U);
}

TEST(CamLatency, InSpaceAScanTakesHalfAsLongAgain) {
  const auto run = run_cam_latency(case_of("64^3, 8 boards"), {8, 0});
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->scans, 2U);
  // Sweeps of 64: docs/cambus.md, section 5.
  const std::uint64_t scans = 2 * (512 * (64 + 40) + 512 / 3 * 4);
  EXPECT_GE(run->clocks, scans);
  EXPECT_LE(run->clocks, scans + 3000);
}

// Of a piece that lies where modules meet, in the middle of the space.
TEST(CamLatency, WithinItsBoxATrailTakesAsManyScansAndFewerClocks) {
  CamLatencyCase of = eight_boards();
  of.log2_cells = {8, 8, 0};
  of.held_cells = 8;
  of.search = world::cam::SearchKind::Sweep;
  const auto whole = run_cam_latency(of, {5, 0});
  of.search = world::cam::SearchKind::BoundedSweep;
  const auto bounded = run_cam_latency(of, {5, 0});
  ASSERT_TRUE(whole && bounded);
  EXPECT_EQ(whole->lists, 2U);
  EXPECT_EQ(bounded->lists, 2U);
  // The first of a trail, its three doublings, and the last: 32 sweeps of 256 sites, or less.
  EXPECT_EQ(whole->scans, 5U);
  EXPECT_EQ(bounded->scans % 5, 0U) << "in each of as many blocks as there are";
  EXPECT_LT(2 * bounded->clocks, whole->clocks);
}

TEST(CamLatency, AStrokeTakesALookACellOrALeap) {
  EXPECT_EQ(looks_of(35, false), 35);
  EXPECT_EQ(looks_of(35, true), 8 + 3);
  EXPECT_EQ(looks_of(0, true), 0);
}

// Latencies that were made with a known fit: it is found again, and nothing else.
TEST(CamLatency, AFitFindsWhatLatenciesWereMadeWith) {
  const CamLatencyFit truth{41, 0.00017};
  constexpr double kPicture_s = 0.03;
  std::vector<CamLatencyProbe> probes;
  for (CamLatencyCase of : cam_latency_cases()) {
    const double look_s = of.log2_modules == 2 ? 0.0058 : 0.0029;
    if (of.thesis_s > 0) {
      of.thesis_s =
          looks_of(truth.cells, of.search == SearchKind::Leap) * (look_s + truth.host_cost_s) +
          (kPicture_s + truth.host_cost_s) / of.updates_per_picture + kNetwork_s;
    }
    const int looks = looks_of(CamLatencyProbe::kCells, of.search == SearchKind::Leap);
    probes.push_back({of, looks * look_s, looks * (look_s + CamLatencyProbe::kHost_s), kPicture_s});
  }
  const CamLatencyFit fit = fit_cam_latency(probes);
  EXPECT_EQ(fit.cells, truth.cells);
  EXPECT_NEAR(fit.host_cost_s, truth.host_cost_s, 1e-9);
}

// The thesis's own latencies, but for one.
CamLatencyReport report_with(std::size_t row, double share) {
  std::vector<CamLatencyRow> rows;
  for (const CamLatencyCase& of : cam_latency_cases()) {
    rows.push_back({of, {.latency_s = of.thesis_s > 0 ? of.thesis_s : 1}});
  }
  rows.at(row).run.latency_s *= 1 + share;
  return tell_cam_latency({34, 5e-5}, rows);
}

TEST(CamLatency, EachOfTheThesisHasToBeWithinATenth) {
  for (const std::size_t row : {0U, 1U, 2U}) {
    EXPECT_TRUE(report_with(row, 0.09).is_within) << row;
    EXPECT_TRUE(report_with(row, -0.09).is_within) << row;
    EXPECT_FALSE(report_with(row, 0.11).is_within) << row;
    EXPECT_FALSE(report_with(row, -0.11).is_within) << row;
  }
  EXPECT_TRUE(report_with(3, 10).is_within) << "of this one the thesis has none";
}

TEST(CamLatency, TheTableHasWhatItWasFittedWithAndHowFarEachIsOff) {
  const std::string text = report_with(1, 0.11).text;
  EXPECT_THAT(text, HasSubstr("34 cells of the plane an update, 0.05 ms of host a list"));
  EXPECT_THAT(text, ContainsRegex("\n8 boards  .* 138\\.8 .* 125 ms   25 mm \\+11\\.0 %\n"));
  EXPECT_THAT(text, ContainsRegex("\n8 boards, leap  .* 35 ms    7 mm  \\+0\\.0 %\n"));
}

}  // namespace
}  // namespace thimble::lab
