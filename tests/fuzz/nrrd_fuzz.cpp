#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "daemon/world/io/field_file.hpp"
#include "daemon/world/io/nrrd.hpp"
#include "hal/base/check.hpp"
#include "tests/fuzz/sentence.hpp"

// Any bytes, behind their header or in a file of their own, give a grid that they are long enough
// for, or one short printable sentence.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  const auto bytes = std::as_bytes(std::span(data, size));
  world::MemorySource source(bytes);
  const auto open_data =
      [&](const std::string& name) -> Result<std::unique_ptr<world::ByteSource>> {
    THIMBLE_CHECK(!name.empty() && name.front() != '/');
    THIMBLE_CHECK(("/" + name + "/").find("/../") == std::string::npos);
    return std::make_unique<world::MemorySource>(bytes);
  };
  // Compressed, a few bytes say many numbers: no more than load soon.
  world::MemorySource again(bytes);
  const auto shape = world::read_nrrd_shape(again, open_data, {});
  if (shape && std::uint64_t{shape->sizes[0]} * shape->sizes[1] * shape->sizes[2] <= 1U << 16U) {
    world::MemorySource field_source(bytes);
    const auto field = world::load_nrrd_field(field_source, open_data, {});
    if (!field) fuzz::require_sentence(field.error(), 512);
    if (field) THIMBLE_CHECK(field->steepest() >= 1);
  }
  const auto grid = world::load_nrrd(source, open_data, {.threshold = 1});
  if (!grid) {
    fuzz::require_sentence(grid.error(), 512);
    return 0;
  }
  const auto& n = grid->cells();
  THIMBLE_CHECK(n[0] >= 1 && n[1] >= 1 && n[2] >= 1);
  THIMBLE_CHECK(n[0] <= 1024 && n[1] <= 1024 && n[2] <= 1024);
  return 0;
}
