#pragma once

#include <functional>
#include <memory>
#include <string>

#include "daemon/world/io/byte_source.hpp"
#include "daemon/world/io/volume_writer.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Opens the data file that a detached header names. Errors name it.
using DataOpener = std::function<Result<std::unique_ptr<ByteSource>>(const std::string&)>;

// Reads a three-dimensional NRRD volume as occupancy: the axis that runs fastest is the world's x,
// index 0 at the negative end, unless the options order the axes otherwise.
//
// Checks header, sizes and lengths before it allocates the grid and the labels of its materials
// (MaterialMap); holds 350 KiB beside both, whatever the file says of itself. A file that holds
// more than its sizes ask for is refused, too.
// Where `materials` is not null, it gets what the options say of them.
// Errors: Malformed, TooLarge, Unsupported, System, and those of the opener, each naming the field;
// load_nrrd_file() puts the path in front.
[[nodiscard]] Result<VoxelGrid> load_nrrd(ByteSource& source, const DataOpener& open_data,
                                          const VolumeOptions& options,
                                          MaterialMap* materials = nullptr);
[[nodiscard]] Result<VoxelGrid> load_nrrd_file(const std::string& path,
                                               const VolumeOptions& options,
                                               MaterialMap* materials = nullptr);
// The same numbers, whatever becomes of them.
[[nodiscard]] Result<void> read_nrrd(ByteSource& source, const DataOpener& open_data,
                                     const VolumeOptions& options, const SinkMaker& make_sink);
// What the file says of its shape; data files are opened, too.
[[nodiscard]] Result<VolumeShape> read_nrrd_shape(ByteSource& source, const DataOpener& open_data,
                                                  const VolumeOptions& options);
// Opens data files in the folder of `path`, and nowhere else.
[[nodiscard]] DataOpener beside(const std::string& path);
// All that load_nrrd_file() checks before it allocates: everything but the numbers themselves.
[[nodiscard]] Result<void> check_nrrd_file(const std::string& path, const VolumeOptions& options);

}  // namespace thimble::world
