#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "daemon/world/ghost_slide.hpp"
#include "daemon/world/occupancy_mirror.hpp"
#include "daemon/world/occupancy_teller.hpp"
#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

// Teller and mirror with a network between them that loses, delays and overtakes: who hears takes
// only what is newer than all he has.
class ToldWorld {
 public:
  ToldWorld(VoxelGrid the_grid, std::uint32_t seed, double loss, std::uint32_t delay)
      : grid(std::move(the_grid)), random_(seed), loss_(loss), delay_(delay) {
    teller.reset();
    EXPECT_TRUE(mirror.begin(grid.lattice()));
  }

  void tick(Cell ghost) {
    ++now_;
    answers_.insert({now_ + lag(), {++number_, teller.tell(grid, ghost, number_)}});
    for (; !answers_.empty() && answers_.begin()->first <= now_; answers_.erase(answers_.begin())) {
      const auto& [number, blocks] = answers_.begin()->second;
      if (is_lost() || number <= applied_) continue;
      const std::uint64_t later = number - applied_;
      before_ = later < 64 ? before_ << later : 0;
      if (applied_ > 0 && later <= 64) before_ |= std::uint64_t{1} << (later - 1);
      applied_ = number;
      for (const OccupancyBlock& block : blocks) (void)mirror.learn(block);
    }
    acks_.insert({now_ + lag(), {applied_, before_}});
    for (; !acks_.empty() && acks_.begin()->first <= now_; acks_.erase(acks_.begin())) {
      const auto& [newest, before] = acks_.begin()->second;
      if (!is_lost()) teller.acknowledge(newest, before);
    }
  }
  // Until the teller has nothing left to tell of, at most `most` answers.
  bool settle(Cell ghost, int most) {
    for (int i = 0; i < most; ++i) {
      tick(ghost);
      if (number_ > kMirrorSlots / 8 && teller.open_blocks() == 0) return true;
    }
    return false;
  }
  [[nodiscard]] int cells_that_differ(std::int32_t reach_cells, Cell about) const {
    int differ = 0;
    for_each_cell(grid, [&](Cell c) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::abs(c[axis] - about[axis]) > reach_cells) return;
      }
      if (!mirror.is_known(c) || mirror.is_occupied(c) != grid.is_occupied(c)) ++differ;
    });
    return differ;
  }

  VoxelGrid grid;
  OccupancyTeller teller{};
  OccupancyMirror mirror{};

 private:
  struct Said {
    std::uint64_t number{0};
    ToldBlocks blocks{};
  };
  struct Ack {
    std::uint64_t newest{0};
    std::uint64_t before{0};
  };
  std::uint64_t lag() { return delay_ == 0 ? 0 : random_() % delay_; }
  bool is_lost() { return uniform(random_, 0, 1) < loss_; }

  std::mt19937 random_;
  double loss_;
  std::uint32_t delay_;
  std::uint64_t now_{0};
  std::uint64_t number_{0};
  std::uint64_t applied_{0};
  std::uint64_t before_{0};
  std::multimap<std::uint64_t, Said> answers_{};
  std::multimap<std::uint64_t, Ack> acks_{};
};

constexpr std::int32_t kWhole_cells = 1024;

VoxelGrid grid_of(std::mt19937& random, std::uint32_t most_cells, double share_occupied) {
  std::array<std::uint32_t, 3> cells{};
  for (auto& count : cells) count = 1 + static_cast<std::uint32_t>(random() % most_cells);
  VoxelGrid grid = empty_grid(cells);
  for_each_cell(grid,
                [&](Cell c) { grid.set_occupied(c, uniform(random, 0, 1) < share_occupied); });
  return grid;
}

Cell any_cell(std::mt19937& random, const VoxelGrid& grid) {
  Cell cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = index_below(random, grid.cells()[axis]);
  }
  return cell;
}

TEST(Occupancy, AWorldOf64CellsAnEdgeIsKnownWholeAfter128Answers) {
  std::mt19937 random(700);
  VoxelGrid grid = empty_grid({64, 64, 64});
  for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, random() % 2 == 0); });
  ToldWorld sut(std::move(grid), 1, 0, 0);
  const Cell corner{63, 0, 40};
  for (int i = 0; i < 128; ++i) sut.tick(corner);
  EXPECT_EQ(sut.cells_that_differ(kWhole_cells, corner), 0);
}

TEST(Occupancy, WhatIsKnownIsRightOnAnyNetworkAndInTimeAllIsKnown) {
  std::mt19937 random(701);
  for (std::uint32_t run = 0; run < 40; ++run) {
    ToldWorld sut(grid_of(random, 40, 0.4), run, uniform(random, 0, 0.4),
                  static_cast<std::uint32_t>(random() % 60));
    Cell ghost = any_cell(random, sut.grid);
    for (int i = 0; i < 60; ++i) {
      sut.tick(ghost);
      if (i % 10 == 0) ghost = any_cell(random, sut.grid);
      for_each_cell(sut.grid, [&](Cell c) {
        if (sut.mirror.is_known(c)) {
          ASSERT_EQ(sut.mirror.is_occupied(c), sut.grid.is_occupied(c)) << run;
        }
      });
    }
    EXPECT_TRUE(sut.settle(ghost, 20'000)) << run;
    EXPECT_EQ(sut.cells_that_differ(kWhole_cells, ghost), 0) << run;
  }
}

TEST(Occupancy, ChangesAreToldAlsoWhereSomeAreLostOnTheWay) {
  std::mt19937 random(702);
  for (std::uint32_t run = 0; run < 25; ++run) {
    ToldWorld sut(grid_of(random, 40, 0.3), run, uniform(random, 0, 0.4),
                  static_cast<std::uint32_t>(random() % 60));
    Cell ghost = any_cell(random, sut.grid);
    for (int i = 0; i < 400; ++i) {
      if (i % 3 == 0) sut.grid.set_occupied(any_cell(random, sut.grid), random() % 2 == 0);
      if (i % 50 == 0) ghost = any_cell(random, sut.grid);
      sut.tick(ghost);
    }
    // Each place has its turn once in 64 answers.
    for (int i = 0; i < 64; ++i) sut.tick(ghost);
    EXPECT_TRUE(sut.settle(ghost, 20'000)) << run;
    EXPECT_EQ(sut.cells_that_differ(kWhole_cells, ghost), 0) << run;
  }
}

TEST(Occupancy, AChangeBesideTheGhostGoesWithTheNextAnswer) {
  std::mt19937 random(703);
  ToldWorld sut(empty_grid({64, 64, 64}), 1, 0, 0);
  const Cell ghost{30, 31, 32};
  ASSERT_TRUE(sut.settle(ghost, 1000));
  for (int i = 0; i < 200; ++i) {
    Cell beside = ghost;
    for (std::size_t axis = 0; axis < 3; ++axis) beside[axis] += index_below(random, 17) - 8;
    sut.grid.set_occupied(beside, i % 3 != 0);
    sut.tick(ghost);
    EXPECT_EQ(sut.mirror.is_occupied(beside), sut.grid.is_occupied(beside)) << i;
  }
}

// Also once there was nothing left to look for, wherever it is.
TEST(Occupancy, AChangeInAGridThatStayedIsToldWithinATurn) {
  std::mt19937 random(706);
  ToldWorld sut(empty_grid({60, 64, 50}), 1, 0, 0);
  const Cell ghost{30, 31, 32};
  for (int run = 0; run < 40; ++run) {
    for (int i = 0; i < 200; ++i) sut.tick(ghost);
    const Cell cell = any_cell(random, sut.grid);
    sut.grid.set_occupied(cell, !sut.grid.is_occupied(cell));
    for (int i = 0; i < 65; ++i) sut.tick(ghost);
    EXPECT_EQ(sut.cells_that_differ(kWhole_cells, ghost), 0) << run;
  }
}

TEST(Occupancy, OfALargeWorldWhatIsAroundTheGhostIsKnownWhereverItGoes) {
  std::mt19937 random(704);
  VoxelGrid grid = empty_grid({200, 9, 130});
  for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, random() % 3 == 0); });
  ToldWorld sut(std::move(grid), 5, 0.1, 10);
  for (int run = 0; run < 12; ++run) {
    const Cell ghost = any_cell(random, sut.grid);
    for (int i = 0; i < 400; ++i) sut.tick(ghost);
    EXPECT_EQ(sut.cells_that_differ(24, ghost), 0) << run;
  }
}

TEST(Occupancy, TheNearestIsToldFirstAndNothingOnceAllIsKnown) {
  const VoxelGrid grid = empty_grid({64, 64, 64});
  OccupancyTeller sut;
  sut.reset();
  const Cell ghost{20, 60, 33};
  const ToldBlocks first = sut.tell(grid, ghost, 1);
  ASSERT_EQ(first.size(), kMostBlocksTold);
  EXPECT_EQ(first[0].at, block_of(ghost));
  std::uint64_t number = 1;
  while (number < 400) {
    sut.acknowledge(number, ~std::uint64_t{0});
    ++number;
    if (sut.tell(grid, ghost, number).empty()) break;
  }
  EXPECT_EQ(number, 129U);
}

TEST(Occupancy, WhatIsNotKnownToHaveArrivedIsToldAgainTheLongestAgoFirst) {
  const VoxelGrid grid = empty_grid({24, 16, 8});
  OccupancyTeller sut;
  sut.reset();
  std::set<std::size_t> told;
  for (std::uint64_t number = 1; number <= 3; ++number) {
    if (number == 3) {
      EXPECT_EQ(told.size(), 6U);
    }
    for (const OccupancyBlock& block : sut.tell(grid, {0, 0, 0}, number)) {
      told.insert(slot_of(block.at));
    }
  }
  EXPECT_EQ(sut.open_blocks(), 6U);
  sut.acknowledge(4, ~std::uint64_t{0});
  EXPECT_EQ(sut.open_blocks(), 6U) << "an answer that was never given has not arrived";
  sut.acknowledge(2, 1);
  EXPECT_EQ(sut.open_blocks(), 0U);
}

// Of each block in which answer it was told last, kept beside the teller, and whether it has
// arrived.
TEST(Occupancy, OfAllThatIsOpenTheFourThatWereToldTheLongestAgoAreNextUnderRandomAcknowledgements) {
  const VoxelGrid grid = empty_grid({64, 64, 64});
  std::mt19937 random(707);
  OccupancyTeller sut;
  sut.reset();
  std::map<std::size_t, std::uint64_t> open;
  std::vector<ToldBlocks> answers(1);
  for (std::uint64_t number = 1; number < 1500; ++number) {
    std::vector<std::uint64_t> longest_ago;
    for (const auto& [slot, told_in] : open) longest_ago.push_back(told_in);
    std::sort(longest_ago.begin(), longest_ago.end());
    longest_ago.resize(std::min(longest_ago.size(), kMostBlocksTold));
    answers.push_back(sut.tell(grid, {32, 32, 32}, number));
    std::vector<std::uint64_t> told_again;
    for (const OccupancyBlock& block : answers.back()) {
      std::uint64_t& told_in = open[slot_of(block.at)];
      if (told_in > 0) told_again.push_back(std::exchange(told_in, number));
      told_in = number;
    }
    // In the first 128 all is told for the first time.
    EXPECT_EQ(told_again, number <= 128 ? std::vector<std::uint64_t>{} : longest_ago) << number;
    if (number < 200 || random() % 4 != 0) continue;
    const std::uint64_t arrived = number - random() % 150;
    sut.acknowledge(arrived, 0);
    for (const OccupancyBlock& block : answers[arrived]) open.erase(slot_of(block.at));
  }
  EXPECT_LT(open.size(), 100U);
}

TEST(Occupancy, ABlockThatTheGhostLeftAndCameBackToIsToldUntilItHasArrived) {
  const VoxelGrid grid = empty_grid({400, 8, 8});
  OccupancyTeller sut;
  sut.reset();
  const Cell here{100, 4, 4};
  const Cell far{300, 4, 4};
  std::set<std::int16_t> told;
  for (std::uint64_t number = 1; number <= 200; ++number) {
    const bool is_here = number % 2 == 0;
    for (const OccupancyBlock& block : sut.tell(grid, is_here ? here : far, number)) {
      EXPECT_LE(std::abs(block.at[0] - (is_here ? 12 : 37)), 4) << "it is not of this window";
      told.insert(block.at[0]);
    }
  }
  EXPECT_TRUE(told.contains(12));
  EXPECT_TRUE(told.contains(37));
  EXPECT_FALSE(sut.tell(grid, here, 201).empty());
}

TEST(OccupancyMirror, AGhostSlidesThroughItAsThroughTheGridBitForBit) {
  std::mt19937 random(705);
  for (std::uint32_t run = 0; run < 60; ++run) {
    ToldWorld sut(grid_of(random, 20, 0.3), run, 0, 0);
    Cell cell = any_cell(random, sut.grid);
    sut.grid.set_occupied(cell, false);
    ASSERT_TRUE(sut.settle(cell, 1000));
    GhostPoint ghost{center_of(sut.grid, cell), cell};
    for (int i = 0; i < 200; ++i) {
      const Position3 target = random_point(random, sut.grid);
      const Slide expected = slide_ghost(sut.grid, ghost, target);
      const Slide found = slide_ghost(sut.mirror, ghost, target);
      ASSERT_EQ(found.ghost.position, expected.ghost.position);
      ASSERT_EQ(found.ghost.cell, expected.ghost.cell);
      ASSERT_EQ(found.held, expected.held);
      ghost = found.ghost;
    }
  }
}

TEST(OccupancyMirror, LearnsNothingThatCannotBe) {
  OccupancyMirror sut;
  EXPECT_FALSE(sut.learn({.at = {0, 0, 0}, .version = 1})) << "there is no world yet";
  const VoxelGrid grid = empty_grid({20, 20, 20});
  ASSERT_TRUE(sut.begin(grid.lattice()));
  EXPECT_FALSE(sut.learn({.at = {3, 0, 0}, .version = 1}));
  EXPECT_FALSE(sut.learn({.at = {0, -1, 0}, .version = 1}));
  EXPECT_FALSE(sut.learn({.at = {0, 0, 32767}, .version = 1}));
  EXPECT_FALSE(sut.learn({.at = {0, 0, 0}, .version = 0}));
  EXPECT_FALSE(sut.is_known({0, 0, 0}));
  EXPECT_TRUE(sut.learn({.at = {2, 2, 2}, .version = 5}));
  EXPECT_FALSE(sut.learn({.at = {2, 2, 2}, .version = 5}));
  EXPECT_TRUE(sut.is_known({16, 19, 16}));
  EXPECT_TRUE(sut.is_occupied({20, 0, 0})) << "outside the world";
  CellLattice endless = grid.lattice();
  endless.cells[1] = 0;
  EXPECT_FALSE(sut.begin(endless));
  EXPECT_FALSE(sut.is_known({16, 19, 16}) && !sut.is_occupied({16, 19, 16}));
}

}  // namespace
}  // namespace thimble::world
