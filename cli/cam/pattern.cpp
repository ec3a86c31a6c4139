#include "cli/cam/pattern.hpp"

#include "cli/file_text.hpp"
#include "daemon/world/io/npy.hpp"
#include "daemon/world/io/nrrd.hpp"

namespace thimble::cam {
namespace {

Pattern pattern_of(const world::VoxelGrid& grid) {
  const auto cells = grid.cells();
  Pattern pattern{{cells[0], cells[1], cells[2]}, {}};
  pattern.cells.resize(pattern.size[0] * pattern.size[1] * pattern.size[2]);
  for (std::size_t i = 0; i < pattern.cells.size(); ++i) {
    const std::size_t row = i / pattern.size[0];
    pattern.cells[i] = grid.is_occupied({static_cast<std::int32_t>(i % pattern.size[0]),
                                         static_cast<std::int32_t>(row % pattern.size[1]),
                                         static_cast<std::int32_t>(row / pattern.size[1])});
  }
  return pattern;
}

}  // namespace

Result<Pattern> read_pattern(const std::string& file) {
  if (file.ends_with(".npy")) {
    return world::load_npy_file(file, {}).map(pattern_of);
  }
  if (file.ends_with(".nrrd") || file.ends_with(".nhdr")) {
    return world::load_nrrd_file(file, {}).map(pattern_of);
  }
  if (!file.ends_with(".rle")) {
    return fail(Errc::InvalidArgument,
                file + ": a pattern's name ends in .rle, .npy, .nrrd or .nhdr");
  }
  const auto text = cli::read_at_most(file, kMaxPatternBytes + 1);
  if (!text) return tl::unexpected(text.error().in(file));
  if (text->size() > kMaxPatternBytes) {
    return fail(Errc::TooLarge, file + ": has more than 64 MiB");
  }
  return parse_rle(*text).map_error([&](const Error& error) { return error.in(file); });
}

}  // namespace thimble::cam
