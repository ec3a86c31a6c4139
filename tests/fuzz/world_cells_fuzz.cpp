#include <cstddef>
#include <cstdint>
#include <string_view>

#include "cli/cells.hpp"
#include "cli/picture/snapshot.hpp"
#include "hal/base/check.hpp"
#include "tests/fuzz/sentence.hpp"

// Any bytes that a daemon may answer give cells, as many as they say, that can be drawn, or one
// short printable sentence.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  const auto cells = cli::parse_cells({reinterpret_cast<const char*>(data), size});
  if (!cells) {
    fuzz::require_sentence(cells.error(), 512);
    return 0;
  }
  THIMBLE_CHECK(cells->every > 0);
  const auto volume = picture::volume_of(*cells);
  THIMBLE_CHECK(volume.cells[0] * volume.cells[1] * volume.cells[2] == volume.colors.size());
  THIMBLE_CHECK(volume.colors.size() <= cli::kMostCells);
  THIMBLE_CHECK(cli::to_npy(*cells).size() > cells->values.size());
  return 0;
}
