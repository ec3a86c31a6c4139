#include "lab/cam_latency.hpp"

#include <gtest/gtest.h>

namespace thimble::lab {
namespace {

// On a small space: 8 sweeps of 64 sites a module.
CamLatencyCase eight_boards() {
  CamLatencyCase of = cam_latency_cases().at(1);
  of.log2_cells = 6;
  return of;
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
  EXPECT_DOUBLE_EQ(run->latency_s, run->time_s + kPicture_s + kNetwork_s);
  EXPECT_DOUBLE_EQ(run->offset_m, 0.2 * run->latency_s);
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

TEST(CamLatency, AStrokeTakesALookACellOrALeap) {
  EXPECT_EQ(looks_of(35, false), 35);
  EXPECT_EQ(looks_of(35, true), 8 + 3);
  EXPECT_EQ(looks_of(0, true), 0);
}

// Latencies that were made with a known fit: it is found again, and nothing else.
TEST(CamLatency, AFitFindsWhatLatenciesWereMadeWith) {
  const CamLatencyFit truth{41, 0.00017};
  std::vector<CamLatencyProbe> probes;
  for (CamLatencyCase of : cam_latency_cases()) {
    const double look_s = of.log2_modules == 2 ? 0.0058 : 0.0029;
    if (of.thesis_s > 0) {
      of.thesis_s = looks_of(truth.cells, of.leaps) * (look_s + truth.host_cost_s) +
                    kPicture_s / of.updates_per_picture + kNetwork_s;
    }
    const int looks = looks_of(CamLatencyProbe::kCells, of.leaps);
    probes.push_back({of, looks * look_s, looks * (look_s + CamLatencyProbe::kHost_s)});
  }
  const CamLatencyFit fit = fit_cam_latency(probes);
  EXPECT_EQ(fit.cells, truth.cells);
  EXPECT_NEAR(fit.host_cost_s, truth.host_cost_s, 1e-9);
}

}  // namespace
}  // namespace thimble::lab
