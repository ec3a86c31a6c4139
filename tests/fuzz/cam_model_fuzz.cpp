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

using Words = std::vector<std::uint32_t>;
namespace cam = thimble::sim::cam;

// Straight on through all sites of a module: what scans go in words by.
void lay_out(cam::CamMachine& machine, unsigned log2_sites) {
  constexpr unsigned kScanPerm = 15;
  std::vector<std::uint16_t> permuter(120);
  for (unsigned bit = 0; bit < 24; ++bit) {
    for (unsigned k = 0; k < 5; ++k) permuter[5 * bit + k] = (bit >> k & 1U) != 0 ? 0xffff : 0;
  }
  std::vector<std::uint16_t> format(35);
  for (unsigned k = 0; k < 5; ++k) format[2 + k] = (log2_sites >> k & 1U) != 0 ? 0xffff : 0;
  machine.write(kScanPerm, permuter);
  machine.write(kScanFormat, format);
}

void play(cam::CamMachine& machine, Words& words) {
  constexpr std::uint64_t kMostSteps = 32;
  constexpr std::uint32_t kHead = 16;
  cam::StepInterface board(machine, thimble::bus::SharedWords(words));
  board.write_next_list(kHead);
  const bool has_come_to_rest = board.run(kMostSteps);
  const bool is_executing = board.state() == cam::StepInterface::State::Executing;
  if (has_come_to_rest == is_executing) std::abort();
}

}  // namespace

// Whatever a window holds, the simulated board stays within it, and each of its steps ends; site by
// site and in words the same comes of it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kLog2Sites = 8;
  Words words(std::min<std::size_t>(size, 4096) / 4);
  const std::span<std::uint8_t> window(reinterpret_cast<std::uint8_t*>(words.data()),
                                       4 * words.size());
  std::copy_n(data, window.size(), window.begin());
  shorten(window);
  Words same = words;
  cam::CamMachine machine({{2, 1, 1}, kLog2Sites});
  cam::CamMachine fast({{2, 1, 1}, kLog2Sites}, cam::Scanning::Fast);
  for (cam::CamMachine* one : {&machine, &fast}) lay_out(*one, kLog2Sites);
  play(machine, words);
  play(fast, same);
  if (words != same || machine.now_clocks() != fast.now_clocks()) std::abort();
  for (std::size_t i = 0; i < machine.torus().size(); ++i) {
    if (machine.torus().modules[i].dram != fast.torus().modules[i].dram) std::abort();
  }
  return 0;
}
