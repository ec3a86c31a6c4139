#pragma once

#include "daemon/world/io/buffered_source.hpp"
#include "daemon/world/io/number_sink.hpp"
#include "daemon/world/io/volume_items.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Streams every number that `sink` waits for from `text`: decimal numbers with blanks or line
// ends between them, each one that `type` can hold. Errors: Malformed for anything else, and for an
// end too early; what text and sink say.
[[nodiscard]] Result<void> read_text_items(BufferedSource& text, ItemType type, NumberSink& sink);
// Whether nothing but blanks and line ends is left.
[[nodiscard]] Result<bool> is_text_over(BufferedSource& text);

}  // namespace thimble::world
