#include <gtest/gtest.h>

#include <random>

#include "tests/unit/cam/cam_bench.hpp"

// Scans that wait for the lines and the frames of a monitor, by the clocks of docs/cambus.md,
// sections 2 and 4.
namespace thimble::cambus {
namespace {

using sim::cam::SyncLengths;
using test::CamBench;

constexpr SyncLengths kVga{547, 247, 512, 13};  // at 25 MHz
constexpr std::uint64_t kLine = 547 + 247;
constexpr std::uint64_t kFrame = kLine * (512 + 13);
// A space whose scan is four sweeps of as many sites.
constexpr std::uint64_t kSweep = 512 + 40 + 2 * 4;

class SynchronizedScan : public testing::Test {
 protected:
  // From a frame's beginning that many clocks on: the clocks until it is over.
  std::uint64_t scan_from(std::uint64_t clocks, std::uint32_t sync, SyncLengths lengths = kVga) {
    bench_.machine().wait_for_scan();
    bench_.machine().set_sync(lengths);
    StepListBuilder builder;
    constexpr std::uint64_t kFrameOnBus = 18;  // of the write of `run`
    if (clocks > kFrameOnBus) builder.delay(static_cast<std::uint32_t>(clocks - kFrameOnBus));
    builder.write(RegisterWords(Register::Run).set(field::kSync, sync));
    bench_.play(builder.finish());
    const auto before = bench_.machine().now_clocks();
    bench_.machine().wait_for_scan();
    return bench_.machine().now_clocks() - before;
  }

  CamBench bench_{{{0, 0, 0}, {9, 2, 0}, Division::Mesh}};
};

TEST_F(SynchronizedScan, BeginsEachSweepWithALine) {
  EXPECT_EQ(scan_from(kLine, kSyncLine), 3 * kLine + kSweep);
  EXPECT_EQ(scan_from(kLine - 1, kSyncLine), 1 + 3 * kLine + kSweep);
  EXPECT_EQ(scan_from(kLine + 1, kSyncLine), kLine - 1 + 3 * kLine + kSweep);
}

TEST_F(SynchronizedScan, BeginsWithAFrameAndGoesOnByLines) {
  EXPECT_EQ(scan_from(kLine, kSyncFrame), kFrame - kLine + 3 * kLine + kSweep);
  EXPECT_EQ(scan_from(2 * kFrame - 5, kSyncFrame), 5 + 3 * kLine + kSweep);
}

TEST_F(SynchronizedScan, WaitsALineLongerWhereTheMonitorReturns) {
  EXPECT_EQ(scan_from(510 * kLine, kSyncLine), 4 * kLine + kSweep);
  EXPECT_EQ(scan_from(512 * kLine, kSyncLine), 4 * kLine + kSweep);
  EXPECT_EQ(scan_from(513 * kLine, kSyncLine), 3 * kLine + kSweep);
}

TEST_F(SynchronizedScan, MissesALineThatIsShorterThanItsSweep) {
  const SyncLengths quick{300, 200, 100, 5};
  EXPECT_EQ(scan_from(500, kSyncLine, quick), 3 * 1000 + kSweep);
}

TEST_F(SynchronizedScan, HangsWithoutPulsesUntilAReset) {
  bench_.machine().set_sync({});
  StepListBuilder builder;
  builder.write(RegisterWords(Register::Run).set(field::kSync, kSyncLine));
  bench_.play(builder.finish());
  EXPECT_TRUE(bench_.machine().hangs());
  bench_.machine().reset();
  EXPECT_FALSE(bench_.machine().hangs());
}

// The monitor sees the site as it is before the scan.
TEST_F(SynchronizedScan, IsSeenLineByLineOnTheMonitor) {
  std::mt19937 random(3);
  const auto cells = test::random_cells(bench_.cell_count(), 0xffff, random);
  bench_.put(cells);
  StepListBuilder builder;
  builder.write(
      RegisterWords(Register::Display).set(field::kSource<Register::Display>[1], kMapSite));
  bench_.play(builder.finish());
  static_cast<void>(scan_from(7 * kLine, kSyncLine));
  const auto& monitor = bench_.machine().monitor();
  EXPECT_EQ(monitor.frames(), 1U);
  for (std::size_t line = 0; line < 12; ++line) {
    const auto seen = monitor.line(line);
    ASSERT_EQ(seen.size(), line >= 7 && line < 11 ? 512U : 0U) << line;
    for (std::size_t x = 0; x < seen.size(); ++x) ASSERT_EQ(seen[x], cells[(line - 7) * 512 + x]);
  }
}

TEST_F(SynchronizedScan, OfAModuleThatDoesNotShowItsScanIsNotOnTheMonitor) {
  StepListBuilder builder;
  builder.write(RegisterWords(Register::ShowScan));
  bench_.play(builder.finish());
  static_cast<void>(scan_from(7 * kLine, kSyncLine));
  EXPECT_EQ(bench_.machine().monitor().frames(), 0U);
}

}  // namespace
}  // namespace thimble::cambus
