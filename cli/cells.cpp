#include "cli/cells.hpp"

#include <algorithm>

#include "daemon/world/io/npy_write.hpp"
#include "daemon/world/io/nrrd_header.hpp"
#include "daemon/world/io/nrrd_write.hpp"

namespace thimble::cli {

Result<WorldCells> parse_cells(std::string_view answer) {
  constexpr double kMostEvery = 1024;
  const auto header = world::parse_nrrd_header(answer, true);
  if (!header) return tl::unexpected(header.error());
  WorldCells cells{header->sizes, 1, {}};
  const std::size_t count = std::size_t{1} * cells.sizes[0] * cells.sizes[1] * cells.sizes[2];
  if (count > kMostCells) return fail(Errc::TooLarge, "the world has more cells than are read");
  const auto every = header->spacing.value_or(std::array<double, 3>{1, 1, 1});
  const bool is_plain = header->type.bytes == 1 && header->encoding == world::NrrdEncoding::Raw &&
                        header->data_file.empty() && header->line_skip == 0 &&
                        header->byte_skip == 0 && every[0] >= 1 && every[0] <= kMostEvery;
  answer.remove_prefix(header->header_bytes);
  if (!is_plain || answer.size() != count) {
    return fail(Errc::Malformed, "the daemon's answer is no volume of cells");
  }
  cells.every = static_cast<std::uint32_t>(every[0]);
  cells.values = answer;
  return cells;
}

WorldCells without_particles(WorldCells cells) {
  std::replace(cells.values.begin(), cells.values.end(), kParticleValue, '\0');
  return cells;
}

std::string to_nrrd(const WorldCells& cells) {
  return world::nrrd_head("uint8", cells.sizes) + cells.values;
}

std::string to_npy(const WorldCells& cells) {
  return world::npy_head("|u1", cells.sizes) + cells.values;
}

}  // namespace thimble::cli
