#include "cli/lab/lab_commands.hpp"

#include <gtest/gtest.h>

namespace thimble::lab_commands {
namespace {

// The thesis's latencies, one of them off by so much.
lab::CamLatencyReport report_off_by(double share) {
  std::vector<lab::CamLatencyRow> rows;
  for (const lab::CamLatencyCase& of : lab::cam_latency_cases()) {
    rows.push_back({of, {.latency_s = of.thesis_s}});
  }
  rows.front().run.latency_s *= 1 + share;
  return lab::tell_cam_latency({34, 5e-5}, rows);
}

TEST(LabCommands, ALatencyThatIsOffByMoreThanATenthIsAnExitCode) {
  EXPECT_EQ(print_cam_latency(report_off_by(0.09)), 0);
  EXPECT_EQ(print_cam_latency(report_off_by(0.11)), 1);
  EXPECT_EQ(print_cam_latency(report_off_by(-0.11)), 1);
}

TEST(LabCommands, SoIsABoardThatFailed) {
  EXPECT_EQ(print_cam_latency(fail(Errc::System, "the board burns")), 1);
}

}  // namespace
}  // namespace thimble::lab_commands
