#pragma once

#include "daemon/world/io/buffered_source.hpp"
#include "daemon/world/io/volume_items.hpp"
#include "daemon/world/io/volume_writer.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Streams every number that `writer` waits for from `text`: decimal numbers with blanks or line
// ends between them, each one that `type` can hold. Errors: Malformed for anything else, and for an
// end too early; what text and writer say.
[[nodiscard]] Result<void> read_text_items(BufferedSource& text, ItemType type,
                                           VolumeWriter& writer);
// Whether nothing but blanks and line ends is left.
[[nodiscard]] Result<bool> is_text_over(BufferedSource& text);

}  // namespace thimble::world
