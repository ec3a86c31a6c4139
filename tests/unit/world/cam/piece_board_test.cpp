#include "daemon/world/cam/piece_board.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/unit/world/cam/piece_bench.hpp"
#include "tests/unit/world/cam/piece_oracle.hpp"

namespace thimble::world::cam {
namespace {

using test::PieceBench;
using test::PieceOracle;

struct Setting {
  const char* name;
  CamGeometry space;
  sim::cam::TorusShape board;
  SearchKind search;
  bool counts_apart;
  bool is_dynamic{false};  // and particles drift meanwhile
};
void PrintTo(const Setting& setting, std::ostream* out) { *out << setting.name; }

constexpr CamGeometry kOneModule{{5, 5, 0}, CamDivision::Mesh};
constexpr CamGeometry kStrips{{5, 5, 0}, CamDivision::StripY};
constexpr CamGeometry kCube{{4, 4, 4}, CamDivision::StripY};
constexpr CamGeometry kWide{{6, 5, 0}, CamDivision::StripY};

// What a person would do, and sometimes not.
PieceAction likely(const PieceOracle& oracle, bool is_pressing, int dice) {
  if (oracle.is_free() && dice < 4) return PieceAction::ToggleFree;
  if (dice == 7) return PieceAction::ToggleFree;
  if (dice == 6) return oracle.held() != 0 ? PieceAction::Select : PieceAction::Drop;
  if (oracle.held() != 0) return dice < 2 ? PieceAction::Delete : PieceAction::Drop;
  return is_pressing || dice < 3 ? PieceAction::Select : PieceAction::Delete;
}

class PiecesOnABoard : public testing::TestWithParam<Setting> {
 protected:
  static PieceSettings settings_of(const Setting& setting) {
    return {.space = setting.space,
            .search = setting.search,
            .counts_apart = setting.counts_apart,
            .is_dynamic = setting.is_dynamic};
  }
  static void drift(PieceBench& bench) {
    bench.board().drift();
    bench.pump();
  }
  // Looks, which changes nothing.
  static void look(PieceBench& bench, const PieceOracle& oracle) {
    const PieceState before = bench.board().state();
    bench.board().act(PieceAction::Look, {});
    bench.pump();
    EXPECT_EQ(bench.board().take_outcome(), PieceOutcome::Looked);
    EXPECT_EQ(bench.board().state(), before);
    PieceLayout expected = oracle.picture();
    const CamCells cells = bench.cells();
    for (std::size_t i = 0; GetParam().is_dynamic && i < cells.size(); ++i) {
      if (expected[i] == 0 && (cells[i] & cell::kParticles) != 0) expected[i] = kParticleSeen;
    }
    EXPECT_EQ(bench.board().picture(), expected);
  }
  static void compare(PieceBench& bench, const PieceOracle& oracle) {
    const PieceState& state = bench.board().state();
    EXPECT_EQ(state.grasp, oracle.grasp());
    EXPECT_EQ(state.held, oracle.held());
    EXPECT_EQ(state.touching, oracle.touching());
    EXPECT_EQ(state.is_embedded, oracle.is_embedded());
    EXPECT_EQ(state.is_free_motion, oracle.is_free());
    CamCells cells = bench.cells();
    if (GetParam().search == SearchKind::BoundedSweep) {
      const auto shows = [](std::uint16_t bits) { return (bits & cell::kSelect) != 0; };
      EXPECT_TRUE(std::none_of(cells.begin(), cells.end(), shows)) << "no trail is left";
    }
    const unsigned beside = GetParam().is_dynamic ? cell::kParticles | cell::kDice : 0U;
    for (auto& bits : cells) bits &= (cell::kPart | cell::kMoving) & ~beside;
    EXPECT_EQ(cells, oracle.cells());
  }
};

// Pieces, moved at random, are where a plain array has them: in every cell, after everything.
TEST_P(PiecesOnABoard, AgreeWithAPlainArray) {
  const Setting& setting = GetParam();
  std::mt19937 random(12);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const CamAxes size = cells_along(setting.space);
  const CamAxes middle{size[0] / 2, size[1] / 2, size[2] / 2};
  std::array<int, 11> outcomes{};
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const PieceLayout layout = random_layout(setting.space, 5, seed).value();
    PieceBench bench(settings_of(setting), layout, middle, setting.board);
    PieceOracle oracle(setting.space, layout, middle);
    CamAxes pressed{};
    for (int i = 0; i < 60; ++i) {
      const bool is_pressing = pressed != CamAxes{};
      if (is_pressing ? below(4) == 0 : below(3) != 0) {
        CamAxes way{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const int to = oracle.grasp()[axis] + below(21) - 10;
          way[axis] = std::clamp(to, 0, size[axis] - 1) - oracle.grasp()[axis];
        }
        const CamAxes goal = oracle.grasp();
        bench.board().move(way);
        bench.pump();
        oracle.move(way);
        // What held it back; so pressed, the cell there is within the space.
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const int left = goal[axis] + way[axis] - oracle.grasp()[axis];
          pressed[axis] = left < 0 ? -1 : left > 0 ? 1 : 0;
        }
      } else {
        const PieceAction action =
            below(25) == 0 ? PieceAction::Reset : likely(oracle, is_pressing, below(8));
        bench.board().act(action, pressed);
        bench.pump();
        const PieceOutcome expected = oracle.act(action, pressed);
        pressed = {};
        const auto outcome = bench.board().take_outcome();
        ASSERT_EQ(outcome, expected) << to_string(expected);
        ++outcomes[static_cast<std::size_t>(expected)];
      }
      if (setting.is_dynamic) drift(bench);
      if (i % 3 == 0) look(bench, oracle);
      compare(bench, oracle);
      ASSERT_FALSE(HasFailure()) << seed << ' ' << i;
    }
    EXPECT_EQ(bench.board().counters().failures, 0U);
  }
  for (const PieceOutcome seen :
       {PieceOutcome::Selected, PieceOutcome::Dropped, PieceOutcome::Deleted,
        PieceOutcome::WasReset, PieceOutcome::NothingThere, PieceOutcome::NothingHeld,
        PieceOutcome::AlreadyHeld}) {
    EXPECT_GT(outcomes[static_cast<std::size_t>(seen)], 0) << to_string(seen);
  }
}

INSTANTIATE_TEST_SUITE_P(
    World, PiecesOnABoard,
    testing::Values(
        Setting{"OneCell", kOneModule, {{1, 1, 1}, 10}, SearchKind::OneCell, false},
        Setting{"OneCellCountedApart", kOneModule, {{1, 1, 1}, 10}, SearchKind::OneCell, true},
        Setting{"LeapOnFourModules", kStrips, {{2, 2, 1}, 8}, SearchKind::Leap, false},
        Setting{"LeapCountedApart", kStrips, {{2, 2, 1}, 8}, SearchKind::Leap, true},
        Setting{"LeapInThreeDimensions", kCube, {{2, 1, 1}, 11}, SearchKind::Leap, false},
        Setting{"LeapInADynamicSpace", kCube, {{2, 1, 1}, 11}, SearchKind::Leap, false, true},
        Setting{"SweepAmongParticles", kStrips, {{2, 2, 1}, 8}, SearchKind::Sweep, false, true},
        Setting{"Sweep", kOneModule, {{1, 1, 1}, 10}, SearchKind::Sweep, false},
        Setting{"SweepOnFourModules", kStrips, {{2, 2, 1}, 8}, SearchKind::Sweep, false},
        Setting{"SweepInThreeDimensions", kCube, {{2, 1, 1}, 11}, SearchKind::Sweep, false},
        Setting{"Bounded", kOneModule, {{1, 1, 1}, 10}, SearchKind::BoundedSweep, false},
        Setting{"BoundedOnFourModules", kStrips, {{2, 2, 1}, 8}, SearchKind::BoundedSweep, false},
        Setting{"BoundedAmongParticles",
                kStrips,
                {{2, 2, 1}, 8},
                SearchKind::BoundedSweep,
                false,
                true},
        Setting{"BoundedOnEightModules", kWide, {{2, 2, 2}, 8}, SearchKind::BoundedSweep, false},
        Setting{
            "BoundedInThreeDimensions", kCube, {{2, 1, 1}, 11}, SearchKind::BoundedSweep, false}),
    [](const auto& setting) { return setting.param.name; });

// A square of 8 cells a side, left of the middle of 32.
PieceLayout one_square() {
  PieceLayout layout(kOneModule.cells());
  for (int y = 12; y < 20; ++y) {
    for (int x = 4; x < 12; ++x) layout[index_of(kOneModule, {x, y, 0})] = 7;
  }
  return layout;
}

class OneSquare : public testing::Test {
 protected:
  void move(int x, int y) {
    bench_.board().move({x, y, 0});
    bench_.pump();
  }
  std::optional<PieceOutcome> act(PieceAction action, const CamAxes& pressed = {}) {
    bench_.board().act(action, pressed);
    bench_.pump();
    return bench_.board().take_outcome();
  }
  const PieceState& state() { return bench_.board().state(); }

  PieceBench bench_{{.space = kOneModule}, one_square(), {16, 16, 0}, {{1, 1, 1}, 10}};
};

TEST_F(OneSquare, IsFeltSelectedMovedAndDropped) {
  move(-10, 0);
  EXPECT_EQ(state().grasp, (CamAxes{12, 16, 0})) << "its right face";
  EXPECT_EQ(act(PieceAction::Select), PieceOutcome::NothingThere) << "nobody presses";
  EXPECT_EQ(act(PieceAction::Select, {-1, 0, 0}), PieceOutcome::Selected);
  EXPECT_EQ(state().held, 7);
  EXPECT_EQ(state().grasp, (CamAxes{11, 16, 0})) << "told, though it moved by itself";
  move(10, 5);
  EXPECT_EQ(state().grasp, (CamAxes{21, 21, 0}));
  EXPECT_EQ(act(PieceAction::Drop), PieceOutcome::Dropped);
  EXPECT_TRUE(state().is_embedded) << "the grasp point is within it";
  move(3, 0);
  EXPECT_EQ(state().grasp, (CamAxes{24, 21, 0}));
  EXPECT_FALSE(state().is_embedded);
  move(-5, 0);
  EXPECT_EQ(state().grasp, (CamAxes{22, 21, 0})) << "its right face, where it is now";
}

TEST_F(OneSquare, AHeldPieceWrapsAroundTheEdgesAndIsNotTorn) {
  move(-4, 0);
  ASSERT_EQ(act(PieceAction::Select, {-1, 0, 0}), PieceOutcome::Selected);
  move(-11, 0);
  EXPECT_EQ(act(PieceAction::Drop), PieceOutcome::Dropped);
  const CamCells cells = bench_.cells();
  std::size_t of_it = 0;
  for (const auto bits : cells) of_it += cell::part_of(bits) == 7 ? 1U : 0U;
  EXPECT_EQ(of_it, 64U);
  EXPECT_EQ(cell::part_of(cells[index_of(kOneModule, {31, 16, 0})]), 7);
}

TEST_F(OneSquare, FreeMotionPassesThroughAndIsNoRoomWithin) {
  EXPECT_EQ(act(PieceAction::ToggleFree), PieceOutcome::FreeMotionOn);
  move(-8, 0);
  EXPECT_EQ(state().grasp, (CamAxes{8, 16, 0}));
  EXPECT_EQ(act(PieceAction::Select), PieceOutcome::Selected) << "it lies under the grasp point";
  EXPECT_EQ(act(PieceAction::Select), PieceOutcome::AlreadyHeld);
  EXPECT_EQ(act(PieceAction::Delete), PieceOutcome::Deleted);
  EXPECT_EQ(act(PieceAction::Delete), PieceOutcome::NothingHeld);
  EXPECT_EQ(act(PieceAction::Reset), PieceOutcome::WasReset);
  EXPECT_FALSE(state().is_free_motion);
  EXPECT_EQ(state().grasp, (CamAxes{16, 16, 0}));
}

TEST(TwoSquares, ThereIsNoRoomForAPieceOnAnother) {
  PieceLayout layout = one_square();
  for (int y = 12; y < 20; ++y) {
    for (int x = 20; x < 28; ++x) layout[index_of(kOneModule, {x, y, 0})] = 9;
  }
  PieceBench bench({.space = kOneModule}, layout, {16, 16, 0}, {{1, 1, 1}, 10});
  const auto act = [&](PieceAction action, const CamAxes& pressed = {}) {
    bench.board().act(action, pressed);
    bench.pump();
    return bench.board().take_outcome();
  };
  bench.board().move({-4, 0, 0});
  bench.pump();
  ASSERT_EQ(act(PieceAction::Select, {-1, 0, 0}), PieceOutcome::Selected);
  ASSERT_EQ(act(PieceAction::ToggleFree), PieceOutcome::FreeMotionOn);
  bench.board().move({12, 0, 0});
  bench.pump();
  EXPECT_EQ(act(PieceAction::Drop), PieceOutcome::NoRoom);
  EXPECT_EQ(bench.board().state().held, 7);
  EXPECT_EQ(act(PieceAction::Delete), PieceOutcome::Deleted);
  EXPECT_EQ(sizes_of([&] {
              PieceLayout parts;
              for (const auto bits : bench.cells()) {
                parts.push_back(static_cast<std::uint8_t>(cell::part_of(bits)));
              }
              return parts;
            }())[9],
            64U)
      << "what lay below stays";
}

}  // namespace
}  // namespace thimble::world::cam
