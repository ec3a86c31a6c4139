// How much memory the largest world takes: growth of the resident set, every voxel written.
#include <cstdio>

#include "bench/comparison.hpp"
#include "bench/process_memory.hpp"
#include "bench/reference_bit_volume.hpp"
#include "daemon/world/voxel_grid.hpp"

namespace {

using namespace thimble;

constexpr std::uint32_t kCells = 1024;
constexpr double kVoxels = 1.0 * kCells * kCells * kCells;

template <class Make>
double bytes_a_voxel(const Make& make) {
  const double before = bench::process_bytes("self", "VmRSS").value_or(0);
  const auto volume = make();
  return (bench::process_bytes("self", "VmRSS").value_or(0) - before) / kVoxels;
}

Result<world::VoxelGrid> make_grid() {
  Result<world::VoxelGrid> grid = world::VoxelGrid::create({kCells, kCells, kCells}, 1e-4);
  if (grid) grid->fill();
  return grid;
}

}  // namespace

int main() {
  bench::Slices ours;
  bench::Slices reference;
  bench::alternate(
      bench::kSlices, [&] { ours.push_back(bytes_a_voxel(make_grid)); },
      [&] {
        const auto make = [] {
          return make_reference_bit_volume(static_cast<std::size_t>(kVoxels));
        };
        reference.push_back(bytes_a_voxel(make));
      });
  if (bench::median(ours) < 0.01) {
    std::fputs("bench_voxel_memory: there is no volume in memory\n", stderr);
    return 1;
  }
  bench::print(bench::compare("memory a voxel, 1024^3 cells", "byte",
                              {bench::Goal::Of::Value, 1.0 / 7}, ours, reference));
  return 0;
}
