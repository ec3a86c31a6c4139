#include "daemon/session/piece_file.hpp"

#include <algorithm>
#include <bit>
#include <string_view>

#include "daemon/world/io/npy.hpp"
#include "daemon/world/io/nrrd.hpp"

namespace thimble::session {
namespace {

using world::Cell;
using world::MaterialMap;
using world::VoxelGrid;

constexpr int kMost = world::cam::kMostPieces;

// A material for each of some numbers, which it has for its stiffness: the readers of volumes know
// matter, and few kinds of it at a time.
Result<VoxelGrid> read_numbers(const std::string& path, int from, int to, MaterialMap& numbers) {
  world::VolumeOptions options;
  for (int number = from; number <= to; ++number) {
    const auto exactly = static_cast<double>(number);
    options.materials.push_back({exactly, exactly, {{exactly}, {}, -1}});
  }
  return std::string_view(path).ends_with(".npy") ? world::load_npy_file(path, options, &numbers)
                                                  : world::load_nrrd_file(path, options, &numbers);
}

Result<CamAxes> log2_of(const VoxelGrid& grid, const std::string& path) {
  CamAxes log2{};
  int all = 0;
  for (std::size_t axis = 0; axis < log2.size(); ++axis) {
    const std::uint32_t cells = grid.cells()[axis];
    if (!std::has_single_bit(cells)) {
      return fail(Errc::InvalidArgument,
                  path + ": " + std::to_string(cells) + " cells along an axis are no power of two");
    }
    log2[axis] = std::countr_zero(cells);
    all += log2[axis];
  }
  if (all < kLeastLog2PieceCells || all > kMostLog2PieceCells) {
    return fail(Errc::InvalidArgument, path + ": a space of pieces has 2^" +
                                           std::to_string(kLeastLog2PieceCells) + " to 2^" +
                                           std::to_string(kMostLog2PieceCells) +
                                           " cells, this one 2^" + std::to_string(all));
  }
  return log2;
}

template <typename Each>
void for_each_cell(const CamAxes& log2, const Each& each) {
  std::size_t index = 0;
  for (int z = 0; z < 1 << log2[2]; ++z) {
    for (int y = 0; y < 1 << log2[1]; ++y) {
      for (int x = 0; x < 1 << log2[0]; ++x) each(index++, Cell{x, y, z});
    }
  }
}

}  // namespace

Result<PieceFile> read_piece_file(const std::string& path) {
  constexpr int kAtOnce = static_cast<int>(MaterialMap::kMaxMaterials);
  PieceFile file;
  std::size_t nameless = 0;
  for (int from = 1; from <= kMost; from += kAtOnce) {
    MaterialMap numbers;
    const auto grid = read_numbers(path, from, std::min(from + kAtOnce - 1, kMost), numbers);
    if (!grid) return tl::unexpected(grid.error());
    const auto log2 = log2_of(*grid, path);
    if (!log2) return tl::unexpected(log2.error());
    file.log2_cells = *log2;
    file.layout.resize(std::size_t{1} << ((*log2)[0] + (*log2)[1] + (*log2)[2]));
    nameless = 0;
    for_each_cell(*log2, [&](std::size_t index, Cell cell) {
      const double number = numbers.at(cell).stiffness.newton_per_m;
      if (number > 0) file.layout[index] = static_cast<std::uint8_t>(number);
      if (grid->is_occupied(cell) && file.layout[index] == 0) ++nameless;
    });
  }
  if (nameless > 0) {
    return fail(Errc::InvalidArgument, path + ": " + std::to_string(nameless) +
                                           " numbers are no piece's, 1 to " +
                                           std::to_string(kMost));
  }
  return file;
}

}  // namespace thimble::session
