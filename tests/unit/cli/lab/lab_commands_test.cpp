#include "cli/lab/lab_commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "daemon/session/piece_file.hpp"
#include "lab/piece_separator.hpp"
#include "tests/unit/world/volume_files.hpp"

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

// Pairs of pieces of which neither gets past the other along y, either way.
std::set<std::pair<int, int>> pairs_that_interlock(const world::cam::PieceLayout& layout,
                                                   const CamGeometry& space) {
  std::set<std::pair<int, int>> up;
  std::set<std::pair<int, int>> down;
  const CamAxes cells = world::cam::cells_along(space);
  for (int y = 0; y + 1 < cells[1]; ++y) {
    for (int x = 0; x < cells[0]; ++x) {
      const int lower = layout[world::cam::index_of(space, {x, y, 0})];
      const int upper = layout[world::cam::index_of(space, {x, y + 1, 0})];
      if (lower == 0 || upper == 0 || lower == upper) continue;
      up.insert({lower, upper});
      down.insert({upper, lower});
    }
  }
  std::set<std::pair<int, int>> both;
  std::set_intersection(up.begin(), up.end(), down.begin(), down.end(),
                        std::inserter(both, both.end()));
  return both;
}

class LayoutsOfTheLab : public world::VolumeFiles {};

TEST_F(LayoutsOfTheLab, AreReadAsLayoutsOfPiecesThatInterlock) {
  for (const char* const name : {"pieces.npy", "pieces.nrrd"}) {
    const auto file = layout_file(1, name);
    ASSERT_TRUE(file) << file.error().message;
    const auto read = session::read_piece_file(write(name, *file));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->log2_cells, lab::kSeparatorSpace.log2_cells);
    EXPECT_EQ(read->layout, lab::separator_layout(1).value());
    EXPECT_GE(pairs_that_interlock(read->layout, lab::kSeparatorSpace).size(), 6U);
  }
}

TEST_F(LayoutsOfTheLab, AnotherSeedHasOtherTeeth) {
  EXPECT_NE(layout_file(1, "pieces.npy").value(), layout_file(2, "pieces.npy").value());
}

TEST_F(LayoutsOfTheLab, OtherFilesAreRefusedBeforeAnythingIsMoved) {
  EXPECT_EQ(layout_file(1, "pieces.txt").error().code, Errc::InvalidArgument);
  EXPECT_EQ(run_separate(1, "pieces.txt"), 1);
  EXPECT_EQ(run_separate(1, "/dev/null/pieces.npy"), 1);
}

}  // namespace
}  // namespace thimble::lab_commands
