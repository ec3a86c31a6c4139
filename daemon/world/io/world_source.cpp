#include "daemon/world/io/world_source.hpp"

#include <charconv>
#include <cmath>
#include <string>

#include "daemon/world/io/npy.hpp"
#include "daemon/world/io/nrrd.hpp"
#include "daemon/world/voxel_world.hpp"

namespace thimble::world {
namespace {

constexpr std::string_view kBox = "box:";
constexpr std::string_view kNpy = ".npy";

[[nodiscard]] Result<std::uint32_t> cells_of_box(const std::string& source) {
  std::uint32_t cells = 0;
  const char* const end = source.data() + source.size();
  const auto [rest, error] = std::from_chars(source.data() + kBox.size(), end, cells);
  if (error == std::errc{} && rest == end) return cells;
  return fail(Errc::InvalidArgument, source + ": expected box:N with N from 3 to 1024");
}

[[nodiscard]] Result<void> check_workspace(const std::string& source, double workspace_m) {
  if (std::isfinite(workspace_m) && workspace_m > 0) return {};
  return fail(Errc::InvalidArgument, source + ": workspace: is not a length greater than 0");
}

[[nodiscard]] bool is_nrrd(const std::string& source) {
  return source.ends_with(".nrrd") || source.ends_with(".nhdr");
}

[[nodiscard]] tl::unexpected<Error> unknown(const std::string& source) {
  return fail(Errc::InvalidArgument, source +
                                         ": expected box:N or the path of a file that ends in "
                                         ".npy, .nrrd or .nhdr");
}

[[nodiscard]] Result<VoxelGrid> make_grid(const std::string& source, const VolumeOptions& options,
                                          MaterialMap& materials) {
  if (source.starts_with(kBox)) {
    const auto cells = cells_of_box(source);
    if (!cells) return tl::unexpected(cells.error());
    auto grid = make_box(*cells, options.workspace_m);
    if (!grid) return tl::unexpected(grid.error().in(source));
    return grid;
  }
  if (source.ends_with(kNpy)) return load_npy_file(source, options, &materials);
  if (is_nrrd(source)) return load_nrrd_file(source, options, &materials);
  return unknown(source);
}

// A finger has to be somewhere.
[[nodiscard]] bool has_free_cell(const VoxelGrid& grid) noexcept {
  const auto [columns, rows, layers] = grid.cells();
  Cell row;
  for (row.z = 0; row.z < static_cast<std::int32_t>(layers); ++row.z) {
    for (row.y = 0; row.y < static_cast<std::int32_t>(rows); ++row.y) {
      if (grid.next_free_in_row(row) < static_cast<std::int32_t>(columns)) return true;
    }
  }
  return false;
}

}  // namespace

Result<void> check_world(const std::string& source, const VolumeOptions& options) {
  if (auto good = check_workspace(source, options.workspace_m); !good) return good;
  if (!source.starts_with(kBox)) {
    if (source.ends_with(kNpy)) return check_npy_file(source, options);
    return is_nrrd(source) ? check_nrrd_file(source, options) : Result<void>(unknown(source));
  }
  const auto cells = cells_of_box(source);
  if (!cells) return tl::unexpected(cells.error());
  const auto good = check_box(*cells, options.workspace_m);
  if (!good) return tl::unexpected(good.error().in(source));
  return {};
}

Result<std::unique_ptr<World>> make_world(const std::string& source, const VolumeOptions& options) {
  if (const auto good = check_workspace(source, options.workspace_m); !good) {
    return tl::unexpected(good.error());
  }
  MaterialMap materials;
  auto grid = make_grid(source, options, materials);
  if (!grid) return tl::unexpected(grid.error());
  if (!has_free_cell(*grid)) {
    return fail(
        Errc::InvalidArgument,
        source + ": threshold: every number of the file is above it: no cell is free for a finger");
  }
  return std::make_unique<VoxelWorld>(std::move(*grid), source, std::move(materials));
}

}  // namespace thimble::world
