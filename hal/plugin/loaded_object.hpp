#pragma once

#include <link.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/plugin/plugin_check.hpp"

namespace thimble::plugin {

// What the dynamic linker mapped of a file, and the rights that the file asks for it.
struct Segment {
  std::uintptr_t start{0};
  std::size_t bytes{0};
  bool is_readable{false};
  bool is_executable{false};
};

// Whether all these bytes lie in one segment with that right: what lies between segments belongs
// to nobody. Pure.
[[nodiscard]] bool is_in(const std::vector<Segment>& segments, const void* start, std::size_t bytes,
                         Access access);

// The segments of a loaded object; none when the linker does not know it.
// Thread: control thread, while nothing else loads or unloads.
[[nodiscard]] std::vector<Segment> segments_of(const link_map& object);

}  // namespace thimble::plugin
