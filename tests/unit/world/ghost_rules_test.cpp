#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <vector>

#include "daemon/world/voxel_world.hpp"
#include "tests/unit/world/grids.hpp"

// The rule of all rules, counted: of a million moves in random bitmaps of 32^3 cells none ends
// inside an occupied cell, and none crosses one. The judge has its own bitmap and its own way
// through it.
namespace thimble::world {
namespace {

#if defined(THIMBLE_UNDER_SANITIZER) || !defined(NDEBUG)
constexpr int kWorlds = 10;  // 1/40 where everything is slow
#else
constexpr int kWorlds = 400;
#endif
constexpr int kMovesInWorld = 2500;
constexpr std::int32_t kSide = 32;
constexpr double kCell_m = 0.0028125;  // the thesis's 90 mm in 32 cells: not a power of two

using Index = std::array<std::int32_t, 3>;

class Judge {
 public:
  void fill(Index at) { matter_.set(bit(at)); }
  [[nodiscard]] bool is_free(Index at) const {
    for (const std::int32_t i : at) {
      if (i < 0 || i >= kSide) return false;
    }
    return !matter_.test(bit(at));
  }

  // The free cells whose closed cubes hold the point, up to rounding: several on faces and edges.
  [[nodiscard]] std::vector<Index> free_around(Position3 p) const {
    constexpr double kRounding = 1e-9;  // cells
    std::array<std::vector<std::int32_t>, 3> along;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double in_cells = p[axis] / kCell_m + kSide / 2.0;
      for (const double shifted : {in_cells - kRounding, in_cells + kRounding}) {
        const auto i = static_cast<std::int32_t>(std::floor(shifted));
        if (along[axis].empty() || along[axis].back() != i) along[axis].push_back(i);
      }
    }
    std::vector<Index> found;
    for (const std::int32_t x : along[0]) {
      for (const std::int32_t y : along[1]) {
        for (const std::int32_t z : along[2]) {
          if (is_free({x, y, z})) found.push_back({x, y, z});
        }
      }
    }
    return found;
  }

  // Whether free cells joined by faces lead from one to the other with no step away from it. A
  // ghost only ever nears its hand, along each axis, so whoever is there without such a way went
  // through.
  [[nodiscard]] bool is_way(Index from, Index to) const {
    Index step{};
    std::array<std::int32_t, 3> count{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      step[axis] = to[axis] < from[axis] ? -1 : 1;
      count[axis] = std::abs(to[axis] - from[axis]) + 1;
    }
    std::vector<char> is_reached(
        static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1] * count[2]), 0);
    const auto place = [&](std::int32_t i, std::int32_t j, std::int32_t k) {
      return static_cast<std::size_t>((i * count[1] + j) * count[2] + k);
    };
    for (std::int32_t i = 0; i < count[0]; ++i) {
      for (std::int32_t j = 0; j < count[1]; ++j) {
        for (std::int32_t k = 0; k < count[2]; ++k) {
          if (!is_free({from[0] + i * step[0], from[1] + j * step[1], from[2] + k * step[2]}))
            continue;
          is_reached[place(i, j, k)] =
              (i + j + k == 0 || (i > 0 && is_reached[place(i - 1, j, k)] != 0) ||
               (j > 0 && is_reached[place(i, j - 1, k)] != 0) ||
               (k > 0 && is_reached[place(i, j, k - 1)] != 0))
                  ? 1
                  : 0;
        }
      }
    }
    return is_reached.back() != 0;
  }

  [[nodiscard]] bool is_way(Position3 from, Position3 to) const {
    for (const Index a : free_around(from)) {
      for (const Index b : free_around(to)) {
        if (is_way(a, b)) return true;
      }
    }
    return false;
  }

 private:
  static std::size_t bit(Index at) {
    return static_cast<std::size_t>((at[2] * kSide + at[1]) * kSide + at[0]);
  }
  std::bitset<static_cast<std::size_t>(kSide) * kSide * kSide> matter_;
};

struct Scene {
  Judge judge;
  VoxelWorld world;
};

// Everything from nearly empty to a sponge that just lets a ghost through.
Scene random_scene(std::mt19937& random) {
  VoxelGrid grid = empty_grid({kSide, kSide, kSide}, kCell_m);
  Judge judge;
  const double share = uniform(random, 0.02, 0.7);
  for_each_cell(grid, [&](Cell cell) {
    if (uniform(random, 0, 1) >= share) return;
    grid.set_occupied(cell, true);
    judge.fill({cell.x, cell.y, cell.z});
  });
  return {judge, VoxelWorld(std::move(grid), "random")};
}

// Mostly near the ghost, now and then anywhere; half of them on the lattice, where ties are.
Position3 random_hand(std::mt19937& random, Position3 ghost) {
  const bool is_far = random() % 64 == 0;
  const bool is_on_lattice = random() % 2 == 0;
  Position3 hand;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double reach = is_far ? 17 : 3.5;
    double in_cells = uniform(random, -reach, reach) + (is_far ? 0 : ghost[axis] / kCell_m);
    if (is_on_lattice) in_cells = std::round(2 * in_cells) / 2;
    hand[axis] = in_cells * kCell_m;
  }
  return hand;
}

struct Count {
  int moves{0};
  int inside{0};
  int crossed{0};
  int at_the_hand{0};
  int held{0};
};

Count& operator+=(Count& sum, const Count& more) {
  sum.moves += more.moves;
  sum.inside += more.inside;
  sum.crossed += more.crossed;
  sum.at_the_hand += more.at_the_hand;
  sum.held += more.held;
  return sum;
}

// `cheat`: what is made of the place where the ghost says it is.
template <class Cheat>
Count play(std::mt19937& random, Scene& scene, int moves, Cheat cheat) {
  Count count;
  const auto probe = scene.world.add_probe({});
  EXPECT_TRUE(probe);
  Position3 ghost = scene.world.move_probe(*probe, {}, std::chrono::milliseconds(1)).ghost;
  for (; count.moves < moves; ++count.moves) {
    const Position3 hand = random_hand(random, ghost);
    const ProbeMotion sut = scene.world.move_probe(*probe, hand, std::chrono::milliseconds(1));
    const Position3 end = cheat(sut.ghost, hand);
    if (scene.judge.free_around(end).empty()) {
      ++count.inside;
    } else if (!scene.judge.is_way(ghost, end)) {
      ++count.crossed;
    }
    if (sut.ghost == hand) ++count.at_the_hand;
    if (!sut.planes.empty()) ++count.held;
    ghost = sut.ghost;
  }
  return count;
}

TEST(GhostRules, OfAMillionRandomMovesNoneEndsInsideAnOccupiedCellOrCrossesOne) {
  Count count;
  for (int seed = 0; seed < kWorlds; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    Scene scene = random_scene(random);
    count += play(random, scene, kMovesInWorld, [](Position3 ghost, Position3) { return ghost; });
  }
  std::printf("%d moves in %d random worlds of 32^3 cells: %d ended inside, %d crossed\n",
              count.moves, kWorlds, count.inside, count.crossed);
  EXPECT_EQ(count.moves, kWorlds * kMovesInWorld);
  EXPECT_EQ(count.inside, 0);
  EXPECT_EQ(count.crossed, 0);
  // Neither stuck nor loose: both kinds of move are among them.
  EXPECT_GT(count.at_the_hand, count.moves / 20);
  EXPECT_GT(count.held, count.moves / 4);
}

TEST(GhostRules, TheJudgeSeesAGhostThatGoesWithTheHand) {
  std::mt19937 random(1);
  Scene scene = random_scene(random);
  const Count count =
      play(random, scene, kMovesInWorld, [](Position3, Position3 hand) { return hand; });
  EXPECT_GT(count.inside, 0);
  EXPECT_GT(count.crossed, 0);
}

}  // namespace
}  // namespace thimble::world
