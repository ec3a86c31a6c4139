#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "daemon/world/io/field_file.hpp"
#include "daemon/world/io/npy.hpp"
#include "daemon/world/io/npy_header.hpp"
#include "hal/base/check.hpp"
#include "tests/fuzz/sentence.hpp"

// Any bytes give a grid that the file is long enough for, or one short printable sentence.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::world;
  const auto bytes = std::as_bytes(std::span(data, size));
  MemorySource source(bytes);
  const auto grid = load_npy(source, {});
  if (grid) {
    const auto& n = grid->cells();
    THIMBLE_CHECK(n[0] >= 1 && n[1] >= 1 && n[2] >= 1);
    THIMBLE_CHECK(std::uint64_t{n[0]} * n[1] * n[2] < size);
  } else {
    thimble::fuzz::require_sentence(grid.error(), 256);
  }
  MemorySource again(bytes);
  const auto field = load_npy_field(again, {});
  if (!field) thimble::fuzz::require_sentence(field.error(), 256);
  if (field) THIMBLE_CHECK(field->steepest() >= 1);
  // The text by itself as well, so that no checksum-like length stands before the parser.
  const auto header = parse_npy_text(std::string_view(reinterpret_cast<const char*>(data), size));
  if (!header) thimble::fuzz::require_sentence(header.error(), 256);
  if (header) {
    for (const std::uint32_t count : header->shape) THIMBLE_CHECK(count >= 1 && count <= 1024);
  }
  return 0;
}
