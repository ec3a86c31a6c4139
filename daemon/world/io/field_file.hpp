#pragma once

#include <string>

#include "daemon/world/fields/distance_field.hpp"
#include "daemon/world/io/byte_source.hpp"
#include "daemon/world/io/nrrd.hpp"
#include "daemon/world/io/volume_writer.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// What a configuration says of a volume file whose numbers are signed distances.
struct FieldOptions {
  VolumeOptions volume{};  // threshold and materials mean nothing here
  double unit_m{1};        // of one of the file's numbers
  Position3 center{};      // of the world's middle
};

// Reads a volume as a signed distance field: its numbers, times unit_m, are the distances at the
// middles of the cells that the same file would have as occupancy (VolumeOptions); only cubes:
// every axis has the same spacing.
//
// Checks header, sizes and lengths before it allocates; holds four bytes a number, and what
// load_npy() and load_nrrd() hold. Errors: theirs, Unsupported for cells that are no cubes, and
// those of DistanceField::create(); load_field_file() puts the path in front, and knows the kind of
// a file by its ending.
[[nodiscard]] Result<DistanceField> load_npy_field(ByteSource& source, const FieldOptions& options);
[[nodiscard]] Result<DistanceField> load_nrrd_field(ByteSource& source, const DataOpener& open_data,
                                                    const FieldOptions& options);
[[nodiscard]] Result<DistanceField> load_field_file(const std::string& path,
                                                    const FieldOptions& options);
// All that load_field_file() checks before it allocates: everything but the numbers themselves.
[[nodiscard]] Result<void> check_field_file(const std::string& path, const FieldOptions& options);

}  // namespace thimble::world
