#include <gtest/gtest.h>

#include <random>
#include <utility>

#include "tests/unit/world/cam/piece_bench.hpp"

// Boards that do what they are told and say something else: no piece is held that does not exist,
// and when they tell the truth again all is well.
namespace thimble::world::cam {
namespace {

constexpr CamGeometry kPlane{{5, 5, 0}, CamDivision::StripY};
#ifdef THIMBLE_UNDER_SANITIZER
constexpr unsigned kLieStep = 3;  // each kind of search once, where a board is twenty times as slow
#else
constexpr unsigned kLieStep = 1;
#endif
constexpr std::uint64_t kMostCounted = (1U << 25) - 1;  // of a module's counters

struct LyingBoard : testing::Test {
  PieceLayout layout = random_layout(kPlane, 5, 3).value();
  test::PieceBench bench{{.space = kPlane}, layout, {16, 16, 0}, {{2, 2, 1}, 8}};
  PieceBoard& sut = bench.board();
  bool has_lied = false;

  // In the next answer that has counts.
  void lie_once(int layer, std::uint64_t count) {
    has_lied = false;
    bench.lie([=, this](CamAnswer& answer) {
      if (answer.counts.empty() || std::exchange(has_lied, true)) return;
      answer.counts.back()[static_cast<std::size_t>(layer)] = count;
    });
  }
  void expect_well() {
    EXPECT_FALSE(sut.trouble());
    EXPECT_EQ(sut.counters().failures, 1U);
    EXPECT_EQ(sut.counters().repairs, 1U);
    EXPECT_EQ(sut.state().held, 0);
    const CamAxes at = sut.state().grasp;
    sut.place({3 - at[0], 4 - at[1], 0});
    bench.pump();
    const CamCells cells = bench.cells();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      EXPECT_EQ((cells[i] & cell::kMoving) != 0, i == index_of(kPlane, {3, 4, 0}));
      EXPECT_EQ(cell::part_of(cells[i]), layout[i]);
    }
  }
};

TEST_F(LyingBoard, MoreCellsThanThereAreWereNotCounted) {
  lie_once(cell::kOverlapLayer, kPlane.cells() + 1);
  sut.move({1, 0, 0});
  bench.pump();
  expect_well();
}

TEST_F(LyingBoard, AsManyCellsAsThereAreMayHaveBeenCounted) {
  lie_once(cell::kOverlapLayer, kPlane.cells());
  sut.move({1, 0, 0});
  bench.pump();
  EXPECT_EQ(sut.counters().failures, 0U);
}

TEST_F(LyingBoard, APieceThatIsNotThereIsNotHeld) {
  lie_once(cell::kSelectLayer + 5, 1);  // number 32; there are five
  sut.act(PieceAction::Select, {});
  bench.pump();
  EXPECT_EQ(sut.take_outcome(), PieceOutcome::BoardFailed);
  expect_well();
}

TEST_F(LyingBoard, APieceThatWasDeletedIsNotHeldAgain) {
  lie_once(cell::kSelectLayer + 1, 1);  // number 2, wherever it lies
  sut.act(PieceAction::Select, {});
  bench.pump();
  ASSERT_EQ(sut.state().held, 2);
  sut.act(PieceAction::Delete, {});
  bench.pump();
  ASSERT_EQ(sut.state().sizes[2], 0U);
  lie_once(cell::kSelectLayer + 1, 1);
  sut.act(PieceAction::Select, {});
  bench.pump();
  EXPECT_EQ(sut.state().held, 0);
  EXPECT_EQ(sut.counters().failures, 1U);
}

void tell_anything(std::mt19937& random, CamAnswer& answer) {
  for (CamCounts& counts : answer.counts) {
    if (random() % 4 != 0) continue;
    const std::uint64_t most = random() % 2 == 0 ? kPlane.cells() : kMostCounted;
    counts[random() % counts.size()] = random() % (most + 1);
  }
  for (CamCells& cells : answer.cells) {
    if (random() % 4 != 0) continue;
    for (int i = 0; i < 10; ++i) {
      cells[random() % cells.size()] ^= static_cast<std::uint16_t>(1U << (random() % 16));
    }
  }
}

TEST(LyingBoards, SayWhatTheyWantAndNoPieceIsHeldThatThereIsNoneOf) {
  for (unsigned seed = 1; seed <= 6 && !testing::Test::HasFailure(); seed += kLieStep) {
    std::mt19937 random(seed);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const auto search = seed % 2 == 0 ? SearchKind::Sweep : SearchKind::Leap;
    const PieceLayout layout = random_layout(kPlane, 5, seed).value();
    test::PieceBench bench({.space = kPlane, .search = search}, layout, {16, 16, 0},
                           {{2, 2, 1}, 8});
    PieceBoard& sut = bench.board();
    bench.lie([&](CamAnswer& answer) { tell_anything(random, answer); });
    for (int i = 0; i < 150; ++i) {
      const CamAxes at = sut.state().grasp;
      if (below(2) == 0) {
        sut.move({below(32) - at[0], below(32) - at[1], 0});
      } else {
        sut.act(static_cast<PieceAction>(below(4)), {below(3) - 1, below(3) - 1, 0});
      }
      bench.pump();
      const auto held = static_cast<std::size_t>(sut.state().held);
      ASSERT_TRUE(held == 0 || sut.state().sizes[held] != 0) << held;
    }
    EXPECT_GT(sut.counters().failures, 10U);
    // The truth again; what was done under lies may have to be put as it was at first.
    bench.lie(nullptr);
    sut.act(PieceAction::Reset, {});
    bench.pump();
    const std::uint64_t failures = sut.counters().failures;
    sut.act(PieceAction::Look, {});
    bench.pump();
    EXPECT_EQ(sut.picture(), layout);
    EXPECT_EQ(sut.counters().failures, failures);
  }
}

}  // namespace
}  // namespace thimble::world::cam
