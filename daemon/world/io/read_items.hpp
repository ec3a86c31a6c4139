#pragma once

#include "daemon/world/io/byte_source.hpp"
#include "daemon/world/io/volume_items.hpp"
#include "daemon/world/io/volume_writer.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Streams every number that `writer` waits for from `bytes`, 8192 of them at a time.
// Errors: Malformed when the bytes end early; what bytes and writer say.
[[nodiscard]] Result<void> read_items(ByteStream& bytes, ItemType type, VolumeWriter& writer);

}  // namespace thimble::world
