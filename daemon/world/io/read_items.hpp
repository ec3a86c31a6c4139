#pragma once

#include "daemon/world/io/byte_source.hpp"
#include "daemon/world/io/number_sink.hpp"
#include "daemon/world/io/volume_items.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Streams every number that `sink` waits for from `bytes`, 8192 of them at a time.
// Errors: Malformed when the bytes end early; what bytes and sink say.
[[nodiscard]] Result<void> read_items(ByteStream& bytes, ItemType type, NumberSink& sink);

}  // namespace thimble::world
