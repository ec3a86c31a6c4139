#include "daemon/world/io/nrrd_write.hpp"

#include <algorithm>
#include <vector>

namespace thimble::world {
namespace {

using Sizes = std::array<std::uint32_t, 3>;

Sizes thinned(Sizes sizes, std::uint32_t every) noexcept {
  for (auto& size : sizes) size = (size + every - 1) / every;
  return sizes;
}

}  // namespace

std::string nrrd_head(std::string_view type, const Sizes& sizes, std::string_view keys) {
  std::string head = "NRRD0004\n# written by thimble\ntype: ";
  head += type;
  head += "\ndimension: 3\nsizes:";
  for (const std::uint32_t size : sizes) head += ' ' + std::to_string(size);
  head += "\nencoding: raw\nendian: little\n";
  head += keys;
  return head += '\n';
}

std::string nrrd_of_bytes(const Sizes& sizes, std::span<const std::uint8_t> bytes) {
  return nrrd_head("uint8", sizes).append(bytes.begin(), bytes.end());
}

std::string nrrd_of_grid(const VoxelGrid& grid, std::size_t most) {
  std::uint32_t every = 1;
  Sizes sizes = grid.cells();
  while (std::size_t{1} * sizes[0] * sizes[1] * sizes[2] > most) {
    sizes = thinned(grid.cells(), ++every);
  }
  const auto cell = [&](std::uint32_t index, std::size_t axis) {
    return static_cast<std::int32_t>(std::min(every * index + every / 2, grid.cells()[axis] - 1));
  };
  std::vector<std::uint8_t> bytes;
  bytes.reserve(std::size_t{1} * sizes[0] * sizes[1] * sizes[2]);
  for (std::uint32_t z = 0; z < sizes[2]; ++z) {
    for (std::uint32_t y = 0; y < sizes[1]; ++y) {
      for (std::uint32_t x = 0; x < sizes[0]; ++x) {
        bytes.push_back(grid.is_occupied({cell(x, 0), cell(y, 1), cell(z, 2)}) ? 1 : 0);
      }
    }
  }
  if (every == 1) return nrrd_of_bytes(sizes, bytes);
  const std::string n = ' ' + std::to_string(every);
  return nrrd_head("uint8", sizes, "spacings:" + n + n + n + '\n')
      .append(bytes.begin(), bytes.end());
}

}  // namespace thimble::world
