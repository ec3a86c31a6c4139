#include <gtest/gtest.h>

#include <random>

#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"

// Slices of a space on the monitor of a simulated board, which is reached through the driver alone.
namespace thimble::cambus {
namespace {

using sim::cam::SimCamBoard;
using std::chrono::microseconds;

constexpr Duration kPatience = std::chrono::milliseconds(200);

struct Shown {
  std::array<std::size_t, 3> modules;
  CamGeometry space;
};
void PrintTo(const Shown& shown, std::ostream* out) {
  *out << shown.modules[0] * shown.modules[1] * shown.modules[2] << " modules, "
       << static_cast<int>(shown.space.division);
}

class Bench {
 public:
  explicit Bench(const Shown& of, std::uint32_t clock_hz = 25'000'000)
      : slot_(clock_, {.shape = {of.modules, log2_sites(of)},
                       .clock_hz = clock_hz,
                       .window_bytes = std::size_t{1} << 22}),
        board_(PciPort::open(slot_.open_window(), clock_.now(), kMemoryTurn).value()) {
    EXPECT_TRUE(board_.lay_out(of.space));
  }
  Result<CamAnswer> play(const CamSteps& steps) {
    const auto started = board_.start(steps, kPatience, clock_.now());
    if (!started) return tl::unexpected(started.error());
    while (true) {
      auto answer = board_.poll(clock_.now());
      if (!answer) return tl::unexpected(answer.error());
      if (*answer) return **std::move(answer);
      clock_.run_for(microseconds(2));
    }
  }
  sim::VirtualClock& clock() { return clock_; }
  sim::cam::CamMachine& machine() { return slot_.board().machine(); }

 private:
  static int log2_sites(const Shown& of) {
    const auto& cells = of.space.log2_cells;
    std::size_t modules = of.modules[0] * of.modules[1] * of.modules[2];
    int sites = cells[0] + cells[1] + cells[2];
    for (; modules > 1; modules /= 2) --sites;
    return sites;
  }
  sim::VirtualClock clock_;
  SimCamBoard slot_;
  Board board_;
};

std::shared_ptr<const CamCells> random_cells(const CamGeometry& space) {
  std::mt19937 random(8);
  CamCells cells(space.cells());
  for (auto& cell : cells) cell = static_cast<std::uint16_t>(random());
  return std::make_shared<const CamCells>(std::move(cells));
}

class BoardShow : public testing::TestWithParam<Shown> {};
INSTANTIATE_TEST_SUITE_P(Spaces, BoardShow,
                         testing::Values(Shown{{1, 1, 1}, {{9, 6, 0}, CamDivision::Mesh}},
                                         Shown{{2, 2, 1}, {{8, 7, 0}, CamDivision::StripY}},
                                         Shown{{2, 2, 2}, {{6, 6, 2}, CamDivision::StripY}},
                                         Shown{{2, 1, 1}, {{4, 4, 3}, CamDivision::StripZ}},
                                         Shown{{1, 2, 4}, {{3, 5, 3}, CamDivision::Mesh}}));

// The cells as they are behind a kick, whatever offsets they have.
TEST_P(BoardShow, PutsEachRowOfASliceIntoALineAndLeavesEverythingAsItWas) {
  const CamGeometry space = GetParam().space;
  Bench bench(GetParam());
  ASSERT_TRUE(bench.play({cam_step::WriteCells{random_cells(space)},
                          cam_step::Kick{{{0x0f0f, {1, -1, 0}}}}, cam_step::Run{}}));
  const auto before = bench.play({cam_step::ReadCells{}});
  const int slice = (1 << space.log2_cells[2]) - 1;
  ASSERT_TRUE(
      bench.play({cam_step::Count{CamEvents::Site},
                  cam_step::Run{{.is_scan = false, .takes_counts = true}}, cam_step::Show{slice}}));
  const std::size_t width = std::size_t{1} << space.log2_cells[0];
  const std::size_t rows = std::size_t{1} << space.log2_cells[1];
  const auto& cells = before->cells.at(0);
  const std::size_t first = static_cast<std::size_t>(slice) * width * rows;
  const auto& monitor = bench.machine().monitor();
  EXPECT_EQ(monitor.frames(), 1U);
  for (std::size_t y = 0; y < rows; ++y) {
    const auto line = monitor.line(y);
    ASSERT_EQ(line.size(), width) << y;
    for (std::size_t x = 0; x < width; ++x) ASSERT_EQ(line[x], cells[first + y * width + x]);
  }
  EXPECT_TRUE(monitor.line(rows).empty());
  const auto after = bench.play({cam_step::Run{{.is_scan = false, .takes_counts = true}},
                                 cam_step::ReadCounts{}, cam_step::ReadCells{}});
  EXPECT_EQ(after->counts.at(0), CamCounts{});
  EXPECT_EQ(after->cells.at(0), cells);
  EXPECT_EQ(bench.machine().counters().disturbed_scans, 0U);
  const bool is_in_words = width >= 64;
  EXPECT_EQ(bench.machine().counters().site_by_site == 0, is_in_words);
}

// 60 times a second at every clock: 512 of 525 lines, after a wait for the first.
TEST(BoardShowTime, IsTheRestOfAFrameAndTheLines) {
  const Shown eight{{2, 2, 2}, {{9, 9, 0}, CamDivision::StripY}};
  struct Known {
    std::uint32_t clock_hz;
    double line_clocks;
  };
  for (const Known& known :
       {Known{25'000'000, 794}, {21'000'000, 676}, {20'000'000, 636}, {50'000'000, 1588}}) {
    Bench bench(eight, known.clock_hz);
    const auto cells = random_cells(eight.space);
    ASSERT_TRUE(bench.play({cam_step::WriteCells{cells}, cam_step::Show{}}));
    for (std::size_t y = 0; y < 512; ++y) {
      const auto line = bench.machine().monitor().line(y);
      ASSERT_TRUE(std::equal(line.begin(), line.end(), cells->begin() + static_cast<long>(512 * y),
                             cells->begin() + static_cast<long>(512 * (y + 1))))
          << known.clock_hz << " " << y;
    }
    const double line_s = known.line_clocks / known.clock_hz;
    EXPECT_NEAR(525 * line_s, 1.0 / 60, 0.02 / 60);
    for (const double since_lines : {0.0, 100.5, 400.0}) {
      bench.clock().run_for(std::chrono::duration_cast<Duration>(
          std::chrono::duration<double>(since_lines * line_s)));
      const MonotonicTime before = bench.clock().now();
      ASSERT_TRUE(bench.play({cam_step::Show{}}));
      const double took_s = std::chrono::duration<double>(bench.clock().now() - before).count();
      // The lines before ended 13 lines, and what was left of the last one, before a frame's end.
      const double lines = (since_lines > 13 ? 2 : 1) * 525 - since_lines;
      EXPECT_NEAR(took_s, lines * line_s, line_s + 5e-6) << known.clock_hz << " " << since_lines;
    }
    EXPECT_EQ(bench.machine().monitor().frames(), 4U);
  }
}

TEST(BoardShowTime, OfFewRowsIsOverWhenTheyAre) {
  Bench bench({{2, 2, 1}, {{6, 6, 3}, CamDivision::StripY}});
  ASSERT_TRUE(bench.play({}));
  const MonotonicTime before = bench.clock().now();
  ASSERT_TRUE(bench.play({cam_step::Show{}, cam_step::Show{1}}));
  const double took_s = std::chrono::duration<double>(bench.clock().now() - before).count();
  EXPECT_GT(took_s, 1.0 / 60 + 63 * 794 / 25e6);
  EXPECT_LT(took_s, 2.0 / 60 + 64 * 794 / 25e6);
}

TEST(BoardShow, WhatAMonitorCannotShowIsRefused) {
  const auto why = [](const Shown& of, std::uint32_t clock_hz = 25'000'000) {
    Bench bench(of, clock_hz);
    const auto shown = bench.play({cam_step::Show{}});
    return shown ? Errc{} : shown.error().code;
  };
  EXPECT_EQ(why({{1, 1, 1}, {{10, 1, 0}, CamDivision::Mesh}}), Errc::TooLarge);
  EXPECT_EQ(why({{1, 1, 1}, {{1, 10, 0}, CamDivision::Mesh}}), Errc::TooLarge);
  EXPECT_EQ(why({{2, 1, 1}, {{6, 6, 0}, CamDivision::StripX}}), Errc::InvalidArgument);
  EXPECT_EQ(why({{2, 1, 1}, {{6, 6, 0}, CamDivision::Mesh}}), Errc::InvalidArgument);
  const Shown one{{1, 1, 1}, {{6, 6, 0}, CamDivision::Mesh}};
  EXPECT_EQ(why(one, 19'000'000), Errc::Unsupported);
  EXPECT_FALSE(video_timing(0));
  EXPECT_FALSE(video_timing(4'000'000'000));
}

}  // namespace
}  // namespace thimble::cambus
