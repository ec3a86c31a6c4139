#include "lab/piece_separator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::lab {
namespace {

using world::cam::PieceBoard;
using world::cam::PieceLayout;

constexpr CamGeometry kSpace{{6, 6, 0}, CamDivision::StripY};

class Separator : public testing::Test {
 protected:
  Result<SeparatorReport> separate(const PieceLayout& layout, std::uint64_t seed,
                                   std::uint64_t most_moves) {
    board.emplace([this](MonotonicTime now) { return open(now); }, settings, layout,
                  CamAxes{1, 1, 0});
    const auto wait = [this]() -> Result<void> {
      do {
        board->pump(clock);
        if (board->trouble()) return tl::unexpected(*board->trouble());
      } while (!board->is_ready());
      return {};
    };
    if (const auto ready = wait(); !ready) return tl::unexpected(ready.error());
    return PieceSeparator(*board, layout, seed, wait).run(most_moves);
  }
  Result<std::unique_ptr<CamBoard>> open(MonotonicTime now) {
    auto port = cambus::PciPort::open(slot.open_window(), now);
    if (!port) return tl::unexpected(port.error());
    return std::make_unique<cambus::Board>(*std::move(port));
  }
  // Of each piece, on the board.
  world::cam::PieceSizes sizes() {
    cambus::Board reader(cambus::PciPort::open(slot.open_window(), clock.now()).value());
    EXPECT_TRUE(reader.lay_out(kSpace));
    EXPECT_TRUE(reader.start({cam_step::ReadCells{}}, std::chrono::seconds(1), clock.now()));
    auto answer = reader.poll(clock.now());
    for (int i = 0; i < 100 && answer && !*answer; ++i) answer = reader.poll(clock.now());
    PieceLayout layout;
    for (const std::uint16_t cell : (*answer)->cells.at(0)) {
      layout.push_back(static_cast<std::uint8_t>(world::cam::cell::part_of(cell)));
    }
    return world::cam::sizes_of(layout);
  }

  world::cam::PieceSettings settings{.space = kSpace};
  sim::VirtualClock clock;
  sim::cam::SimCamBoard slot{
      clock, {.shape = {{2, 1, 1}, 11}, .window_bytes = std::size_t{1} << 20, .is_paced = false}};
  std::optional<PieceBoard> board;
};

TEST_F(Separator, InterlockingPiecesFillABlockWithoutGapsAndHaveTeeth) {
  const PieceLayout layout = interlocking_layout(kSpace, 3, 1).value();
  const auto of = [&](int x, int y) { return layout[world::cam::index_of(kSpace, {x, y, 0})]; };
  std::map<int, int> sizes;
  for (const std::uint8_t part : layout) ++sizes[part];
  EXPECT_EQ(sizes.size(), 1U + 9U);
  EXPECT_EQ(sizes[0], 64 * 64 - 30 * 30);
  // Down the first column its edge goes in and out.
  std::map<int, int> widths;
  for (int y = 17; y < 47; ++y) {
    int width = 0;
    while (of(17 + width, y) == of(17, y)) ++width;
    ++widths[width];
  }
  EXPECT_EQ(widths.size(), 2U);
}

TEST_F(Separator, LayoutsThatWouldBeTooThinAreRefused) {
  EXPECT_EQ(interlocking_layout(kSpace, 5, 1).error().code, Errc::InvalidArgument);
  EXPECT_EQ(interlocking_layout(kSpace, 0, 1).error().code, Errc::InvalidArgument);
  EXPECT_EQ(interlocking_layout({{9, 9, 0}}, 8, 1).error().code, Errc::InvalidArgument);
}

TEST_F(Separator, TakesAllPiecesApartAndLosesNoCell) {
  for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{2}}) {
    const PieceLayout layout = interlocking_layout(kSpace, 2, seed).value();
    const auto report = separate(layout, seed, 3000);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->pieces, 4);
    EXPECT_EQ(report->apart, 4);
    EXPECT_GT(report->blocked, 0U) << "they were not apart at first";
    EXPECT_EQ(sizes(), world::cam::sizes_of(layout));
  }
}

// The soak: whatever the teeth and the moves, what the board says is where the pieces must be.
TEST_F(Separator, NinePiecesOfAnySeedComeApartAndLoseNoCell) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const PieceLayout layout = interlocking_layout(kSpace, 3, seed).value();
    const auto report = separate(layout, seed, 3000);
    ASSERT_TRUE(report) << seed << ": " << report.error().message;
    EXPECT_EQ(report->apart, 9) << seed;
    EXPECT_EQ(sizes(), world::cam::sizes_of(layout)) << seed;
  }
}

TEST_F(Separator, TheSameSeedMakesTheSameMoves) {
  const PieceLayout layout = interlocking_layout(kSpace, 2, 1).value();
  const auto once = separate(layout, 7, 60);
  const auto again = separate(layout, 7, 60);
  ASSERT_TRUE(once && again);
  EXPECT_EQ(*once, *again);
}

TEST_F(Separator, MovesNoMoreThanItMay) {
  const PieceLayout layout = interlocking_layout(kSpace, 2, 1).value();
  const auto report = separate(layout, 1, 2);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->moves, 2U);
  EXPECT_LT(report->apart, 4);
}

TEST_F(Separator, LeavesPiecesAloneThatAreApart) {
  PieceLayout layout(kSpace.cells());
  for (const int number : {1, 2, 3}) {
    for (int cell = 0; cell < 16; ++cell) {
      const int x = 12 * number + cell % 4;
      layout[world::cam::index_of(kSpace, {x, 20 + cell / 4, 0})] =
          static_cast<std::uint8_t>(number);
    }
  }
  const auto report = separate(layout, 1, 100);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(*report, (SeparatorReport{3, 3, 0, 0}));
}

// The bound that lets a person wait for it.
TEST(SeparatorForPeople, SixteenPiecesAreApartInTime) {
  for (const std::uint64_t seed : {std::uint64_t{5}, std::uint64_t{13}}) {
    const auto report = report_separator(seed);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(*report,
                testing::StartsWith("16 interlocking pieces in 128 x 128 cells: 16 apart "));
  }
}

TEST_F(Separator, SaysWhenThePiecesAreNotWhereTheyMustBe) {
  const PieceLayout layout = interlocking_layout(kSpace, 2, 1).value();
  PieceLayout other(layout.size());
  other[world::cam::index_of(kSpace, {5, 5, 0})] = 1;
  board.emplace([this](MonotonicTime now) { return open(now); }, settings, layout,
                CamAxes{1, 1, 0});
  const auto wait = [this]() -> Result<void> {
    do {
      board->pump(clock);
    } while (!board->is_ready());
    return {};
  };
  ASSERT_TRUE(wait());
  const auto report = PieceSeparator(*board, other, 1, wait).run(10);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().message, "the board is not as it must be: nothing there");
}

}  // namespace
}  // namespace thimble::lab
