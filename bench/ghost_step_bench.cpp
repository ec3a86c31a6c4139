// What one step of the ghost point costs in the thesis's hollow box, coarse and fine: a hand that
// sweeps it at up to 0.25 m/s and leans on its walls about half of the time, told once a
// millisecond.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "bench/comparison.hpp"
#include "bench/reference_ghost.hpp"
#include "daemon/world/ghost_motion.hpp"
#include "daemon/world/voxel_grid.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kSteps = 1 << 14;  // one slice: 16 s of the hand
constexpr int kRounds = 8;
constexpr double kReach_m = 0.022;  // the room inside reaches 0.015 m

std::vector<Position3> make_path() {
  constexpr std::array kRates_hz{1.1, 1.3, 1.7};
  std::vector<Position3> path;
  for (std::size_t i = 0; i < kSteps; ++i) {
    Position3 hand;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double turns = kRates_hz[axis] * 1e-3 * static_cast<double>(i);
      hand[axis] = kReach_m * std::sin(2 * std::numbers::pi * turns);
    }
    path.push_back(hand);
  }
  return path;
}

template <class Step>
double nanoseconds_a_step(const Step& step) {
  const auto begin = std::chrono::steady_clock::now();
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < kSteps; ++i) step(i);
  }
  const auto end = std::chrono::steady_clock::now();
  return std::chrono::duration<double, std::nano>(end - begin).count() / (kRounds * kSteps);
}

bool run(std::uint32_t cells, const std::vector<Position3>& path) {
  const Result<world::VoxelGrid> grid = world::make_box(cells);
  if (!grid) return false;
  world::GhostState state{
      {{}, {grid->lower_index(0, 0), grid->lower_index(1, 0), grid->lower_index(2, 0)}}};
  ReferenceGhost plain(static_cast<int>(cells), world::kDefaultWorkspace_m);
  std::size_t planes = 0;
  double largest_m = 0;
  const auto step = [&](std::size_t i) {
    planes += world::move_ghost(*grid, state, path[i], std::chrono::milliseconds(1)).planes.size();
    largest_m = std::max(largest_m, std::abs(state.point.position.x));
  };
  double largest_plain_m = 0;
  const auto plain_step = [&](std::size_t i) {
    plain.step({path[i].x, path[i].y, path[i].z});
    largest_plain_m = std::max(largest_plain_m, std::abs(plain.position_m(0)));
  };
  bench::Slices ours;
  bench::Slices reference;
  bench::alternate(
      bench::kSlices, [&] { ours.push_back(nanoseconds_a_step(step)); },
      [&] { reference.push_back(nanoseconds_a_step(plain_step)); });
  // Both met the walls of the same room, or there is nothing to compare.
  if (planes == 0 || std::abs(largest_m - largest_plain_m) > 1e-9 || largest_m > 0.016)
    return false;
  const std::string name = "ghost step, " + std::to_string(cells) + "^3 cells";
  bench::print(bench::compare(name, "ns", {bench::Goal::Of::Value, 100}, ours, reference));
  return true;
}

}  // namespace

int main() {
  const std::vector<Position3> path = make_path();
  for (const std::uint32_t cells : {64U, 512U}) {
    if (run(cells, path)) continue;
    std::fputs("bench_ghost_step: the ghost does not stay in its room\n", stderr);
    return 1;
  }
  return 0;
}
