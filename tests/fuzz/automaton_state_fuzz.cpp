#include <cstddef>
#include <cstdint>
#include <string_view>

#include "daemon/world/cam/automaton_file.hpp"
#include "hal/base/check.hpp"
#include "tests/fuzz/sentence.hpp"

// Any bytes give a state with as many sites as it says, which is written and read again as itself,
// or one short printable sentence.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  const auto state = world::cam::parse_state({reinterpret_cast<const char*>(data), size});
  if (!state) {
    fuzz::require_sentence(state.error(), 512);
    return 0;
  }
  const auto& log2 = state->log2_cells;
  THIMBLE_CHECK(state->sites.size() == std::size_t{1} << (log2[0] + log2[1] + log2[2]));
  THIMBLE_CHECK(world::cam::parse_state(world::cam::to_nrrd(*state)) == *state);
  return 0;
}
