#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

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
