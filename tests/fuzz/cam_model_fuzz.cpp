#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "sim/model/cam/step_interface.hpp"

namespace {

constexpr std::size_t kLengthByte = 8;
constexpr unsigned kRegisterBits = 0x1f;
constexpr unsigned kScanFormat = 17;

// A scan of 2^24 sites ends, but not within the patience of a fuzzer: formats are left alone, and
// no transfer is longer than 65,535 words.
void shorten(std::span<std::uint8_t> window) {
  for (std::size_t at = 0; at + 16 <= window.size(); at += 16) {
    if ((window[at] & kRegisterBits) == kScanFormat) ++window[at];
    window[at + kLengthByte + 2] = 0;
    window[at + kLengthByte + 3] = 0;
  }
}

}  // namespace

// Whatever a window holds, the simulated board stays within it, and each of its steps ends.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace cam = thimble::sim::cam;
  constexpr std::uint64_t kMostSteps = 32;
  constexpr std::uint32_t kHead = 16;
  std::vector<std::uint32_t> words(std::min<std::size_t>(size, 4096) / 4);
  const std::span<std::uint8_t> window(reinterpret_cast<std::uint8_t*>(words.data()),
                                       4 * words.size());
  std::copy_n(data, window.size(), window.begin());
  shorten(window);
  cam::CamMachine machine({{2, 1, 1}, 4});
  cam::StepInterface board(machine, thimble::bus::SharedWords(words));
  board.write_next_list(kHead);
  const bool has_come_to_rest = board.run(kMostSteps);
  const bool is_executing = board.state() == cam::StepInterface::State::Executing;
  if (has_come_to_rest == is_executing) std::abort();
  return 0;
}
