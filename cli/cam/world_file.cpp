#include <array>
#include <string>

#include "cli/cam/pattern.hpp"
#include "cli/cam/run.hpp"
#include "daemon/world/io/npy_write.hpp"

namespace thimble::cam {
namespace {

using sim::cam::SiteSpace;

std::string to_npy(const SiteSpace& space, const std::vector<std::uint16_t>& sites) {
  std::array<std::uint32_t, 3> sizes{};
  for (std::size_t axis = 0; axis < 3; ++axis) sizes[axis] = 1U << space.log2_cells[axis];
  std::string file = world::npy_head("<u2", sizes);
  for (const std::uint16_t site : sites) {
    file += static_cast<char>(site & 0xff);
    file += static_cast<char>(site >> 8);
  }
  return file;
}

Pattern cells_of(const Rule& rule, const SiteSpace& space,
                 const std::vector<std::uint16_t>& sites) {
  const std::size_t half = rule.is_of_blocks ? 1 : 0;
  Pattern pattern{{std::size_t{1} << half << space.log2_cells[0],
                   std::size_t{1} << half << space.log2_cells[1], 1},
                  {}};
  pattern.cells.resize(pattern.size[0] * pattern.size[1]);
  for (std::size_t i = 0; i < pattern.cells.size(); ++i) {
    const std::size_t x = i % pattern.size[0];
    const std::size_t y = i / pattern.size[0];
    const std::uint32_t site = sites[(y >> half) << space.log2_cells[0] | x >> half];
    const std::uint32_t of =
        rule.is_of_blocks ? 1U << ((x & 1) | (y & 1) << 1) : std::uint32_t{rule.visible_layers()};
    pattern.cells[i] = (site & of) != 0;
  }
  return pattern;
}

}  // namespace

Result<std::string> to_file(const Rule& rule, const SiteSpace& space,
                            const std::vector<std::uint16_t>& sites, const std::string& name) {
  if (name.ends_with(".npy")) return to_npy(space, sites);
  if (!name.ends_with(".rle")) {
    return fail(Errc::InvalidArgument, "what is written ends in .npy or .rle");
  }
  if (space.log2_cells[2] > 0) {
    return fail(Errc::InvalidArgument, "an .rle file holds a plane: write .npy");
  }
  const std::string torus = ":T" + std::to_string(std::size_t{1} << space.log2_cells[0]) + "," +
                            std::to_string(std::size_t{1} << space.log2_cells[1]);
  const bool is_life = rule.name == "life";
  return to_rle(cells_of(rule, space, sites), is_life ? "B3/S23" + torus : std::string(rule.name));
}

}  // namespace thimble::cam
