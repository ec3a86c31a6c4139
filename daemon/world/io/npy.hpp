#pragma once

#include <string>

#include "daemon/world/io/byte_source.hpp"
#include "daemon/world/io/volume_writer.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Reads a three-dimensional array of plain numbers as occupancy: volume[x, y, z], index 0 at the
// negative end of each axis, unless the options order the axes otherwise.
//
// Checks header, type, shape and length before it allocates; holds 128 KiB of the file at a time.
// Where `materials` is not null, it gets what the options say of them.
// Errors: Malformed, TooLarge, Unsupported, System, and those of open_file(), each naming
// the field; load_npy_file() puts the path in front.
[[nodiscard]] Result<VoxelGrid> load_npy(ByteSource& source, const VolumeOptions& options,
                                         MaterialMap* materials = nullptr);
[[nodiscard]] Result<VoxelGrid> load_npy_file(const std::string& path, const VolumeOptions& options,
                                              MaterialMap* materials = nullptr);
// The same numbers, whatever becomes of them.
[[nodiscard]] Result<void> read_npy(ByteSource& source, const SinkMaker& make_sink);
// What the file says of its shape, after everything that header and length tell.
[[nodiscard]] Result<VolumeShape> read_npy_shape(ByteSource& source);
// All that load_npy_file() checks before it allocates: everything but the numbers themselves.
[[nodiscard]] Result<void> check_npy_file(const std::string& path, const VolumeOptions& options);

}  // namespace thimble::world
