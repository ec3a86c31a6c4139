#pragma once

#include <algorithm>
#include <cstdint>
#include <random>

#include "daemon/world/voxel_grid.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"

// A hand in worlds of cells drawn at random.
namespace thimble::coupling::testing {

inline double between(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline Position3 middle_of(const world::VoxelGrid& grid, world::Cell cell) {
  Position3 p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    p[axis] = (grid.face_m(axis, cell[axis]) + grid.face_m(axis, cell[axis] + 1)) / 2;
  }
  return p;
}

// A hand that goes to places drawn at random, and gives way where it is held back far.
class ZoneHand {
 public:
  ZoneHand(std::uint64_t seed, Position3 at, double most_m_per_s)
      : random_(seed), at_(at), goal_(at), most_m_per_s_(most_m_per_s) {}

  void move(Position3 ghost, Duration dt) {
    if (random_() % 400 == 0 || norm(at_ - goal_) < 0.001) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        goal_[axis] = at_[axis] + between(random_, -0.08, 0.08);
      }
      speed_m_per_s_ = between(random_, 0.1, 1) * most_m_per_s_;
    }
    const bool gives_way = norm(at_ - ghost) > 0.008;
    if (gives_way) goal_ = at_ + (ghost - at_);
    const Displacement3 way = goal_ - at_;
    const double share = std::min(1.0, speed_m_per_s_ * seconds(dt) / std::max(1e-9, norm(way)));
    const Position3 before = at_;
    at_ = at_ + share * way;
    const Displacement3 moved = at_ - before;
    velocity_ = Velocity3{moved.x, moved.y, moved.z} * (1 / seconds(dt));
  }
  [[nodiscard]] Position3 at() const { return at_; }
  [[nodiscard]] Velocity3 velocity() const { return velocity_; }

 private:
  std::mt19937_64 random_;
  Position3 at_;
  Position3 goal_;
  Velocity3 velocity_{};
  double most_m_per_s_;
  double speed_m_per_s_{0};
};

inline world::VoxelGrid cells_at_random(std::mt19937_64& random, double cell_m) {
  world::VoxelGrid grid = world::VoxelGrid::create({9, 8, 7}, cell_m).value();
  for (world::Cell c; c.z < 7; ++c.z) {
    for (c.y = 0; c.y < 8; ++c.y) {
      for (c.x = 0; c.x < 9; ++c.x) grid.set_occupied(c, random() % 5 == 0);
    }
  }
  grid.set_occupied({4, 4, 3}, false);
  return grid;
}

// As many cells along no two axes, and the origin in the middle of one that is free.
constexpr world::Cell kCellOfTheOrigin{3, 2, 4};
inline world::VoxelGrid cells_round_the_origin(std::mt19937_64& random) {
  world::VoxelGrid grid = world::VoxelGrid::create({7, 5, 9}, 0.030).value();
  for (world::Cell c; c.z < 9; ++c.z) {
    for (c.y = 0; c.y < 5; ++c.y) {
      for (c.x = 0; c.x < 7; ++c.x) grid.set_occupied(c, random() % 6 == 0);
    }
  }
  grid.set_occupied(kCellOfTheOrigin, false);
  return grid;
}

inline world::VoxelGrid room_at_random(std::mt19937_64& random, double cell_m) {
  world::VoxelGrid grid = world::VoxelGrid::create({12, 12, 12}, cell_m).value();
  grid.fill();
  world::Cell first;
  world::Cell last;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = 1 + static_cast<std::int32_t>(random() % 5);
    last[axis] = 6 + static_cast<std::int32_t>(random() % 5);
  }
  for (world::Cell c = first; c.z <= last.z; ++c.z) {
    for (c.y = first.y; c.y <= last.y; ++c.y) {
      for (c.x = first.x; c.x <= last.x; ++c.x) grid.set_occupied(c, false);
    }
  }
  return grid;
}

}  // namespace thimble::coupling::testing
