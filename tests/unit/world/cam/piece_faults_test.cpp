#include <gtest/gtest.h>

#include <random>

#include "tests/unit/world/cam/piece_bench.hpp"
#include "tests/unit/world/cam/piece_oracle.hpp"

// Boards whose programs fail, in the middle of everything: afterwards board and host agree, and no
// piece is lost.
namespace thimble::world::cam {
namespace {

using test::PieceBench;

constexpr CamGeometry kSpace{{5, 5, 0}, CamDivision::StripY};
#ifdef THIMBLE_UNDER_SANITIZER
constexpr std::uint64_t kFaultStep =
    3;  // each kind of search once, where a board is twenty times as slow
#else
constexpr std::uint64_t kFaultStep = 1;
#endif

// What the state says, as cells; resting pieces are taken from the board.
void expect_one_truth(PieceBench& bench, const PieceLayout& first) {
  const PieceState& state = bench.board().state();
  const CamCells cells = bench.cells();
  PieceSizes resting{};
  std::size_t shape = 0;
  std::size_t origin = 0;
  std::size_t overlapped = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ++resting[static_cast<std::size_t>(cell::part_of(cells[i]))];
    shape += (cells[i] & cell::kShape) != 0 ? 1U : 0U;
    origin += (cells[i] & cell::kOrigin) != 0 ? 1U : 0U;
    overlapped += (cells[i] & cell::kShape) != 0 && cell::part_of(cells[i]) != 0 ? 1U : 0U;
    EXPECT_EQ((cells[i] & cell::kGrasp) != 0, i == index_of(kSpace, state.grasp));
  }
  const auto held = static_cast<std::size_t>(state.held);
  EXPECT_EQ(shape, held == 0 ? 1U : state.sizes[held]);
  EXPECT_EQ(origin, held == 0 ? 0U : state.sizes[held]);
  EXPECT_EQ(state.is_embedded, overlapped > 0);
  const PieceSizes sizes = sizes_of(first);
  for (std::size_t part = 1; part < sizes.size(); ++part) {
    EXPECT_TRUE(state.sizes[part] == sizes[part] || state.sizes[part] == 0);
    EXPECT_EQ(resting[part], part == held ? 0 : state.sizes[part]);
  }
  PieceLayout rested(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int part = (cells[i] & cell::kOrigin) != 0 ? state.held : cell::part_of(cells[i]);
    rested[i] = static_cast<std::uint8_t>(part);
  }
  const PieceBoxes boxes = boxes_of(kSpace, rested);
  for (std::size_t part = 1; part < sizes.size(); ++part) {
    EXPECT_TRUE(state.sizes[part] == 0 || state.boxes[part] == boxes[part]) << part;
  }
  // The shape lies as far from the origin as the grasp point from where it was.
  for (std::size_t i = 0; held != 0 && i < cells.size(); ++i) {
    if ((cells[i] & cell::kOrigin) == 0) continue;
    const int x = static_cast<int>(i % 32) + state.grasp[0] - state.held_from[0];
    const int y = static_cast<int>(i / 32) + state.grasp[1] - state.held_from[1];
    EXPECT_TRUE((cells[index_of(kSpace, {x & 31, y & 31, 0})] & cell::kShape) != 0);
  }
}

TEST(PieceFaults, AfterAnyLostProgramBoardAndHostAgree) {
  std::mt19937 random(5);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  std::uint64_t repairs = 0;
  std::uint64_t pictures = 0;
  int failed_actions = 0;
  for (std::uint64_t seed = 1; seed <= 10; seed += kFaultStep) {
    const PieceLayout layout = random_layout(kSpace, 5, seed).value();
    const auto search = seed > 7   ? SearchKind::BoundedSweep
                        : seed > 4 ? SearchKind::Sweep
                                   : SearchKind::Leap;
    PieceBench bench({.space = kSpace, .search = search, .counts_apart = seed % 2 == 0}, layout,
                     {16, 16, 0}, {{2, 2, 1}, 8});
    CamAxes pressed{};
    for (int i = 0; i < 60 && !testing::Test::HasFailure(); ++i) {
      bench.strike(static_cast<std::uint64_t>(1 + below(3)), below(2) == 0);
      const CamAxes before = bench.board().state().grasp;
      if (below(2) == 0) {
        const CamAxes way{below(32) - before[0], below(32) - before[1], 0};
        bench.board().move(way);
        bench.pump();
        for (std::size_t axis = 0; axis < 2; ++axis) {
          const int left = before[axis] + way[axis] - bench.board().state().grasp[axis];
          pressed[axis] = left < 0 ? -1 : left > 0 ? 1 : 0;
        }
      } else if (below(5) == 0) {
        bench.board().show();
      } else {
        // Mostly what changes which piece is held.
        bench.board().act(static_cast<PieceAction>(below(8) == 0 ? 3 : below(3)), pressed);
        pressed = {};
      }
      bench.pump();
      const auto outcome = bench.board().take_outcome();
      if (outcome == PieceOutcome::BoardFailed) ++failed_actions;
      expect_one_truth(bench, layout);
    }
    EXPECT_EQ(bench.board().counters().resets, 0U) << "no piece was lost";
    EXPECT_EQ(bench.board().counters().repairs, bench.board().counters().failures);
    repairs += bench.board().counters().repairs;
    pictures += bench.board().counters().pictures;
  }
  EXPECT_GT(repairs, 40U);
  EXPECT_GT(failed_actions, 10);
  EXPECT_GT(pictures, 10U);
}

}  // namespace
}  // namespace thimble::world::cam
