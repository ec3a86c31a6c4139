#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace thimble::test {

// A boot stream that a simulated Falcon loads: the form of the processor's maker, with noise for
// code. The vendor's own images may not be shipped. `blocks` of up to 400 words each.
inline std::vector<std::uint8_t> falcon_image(unsigned seed = 1, int blocks = 20) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> image;
  const auto put_word = [&](unsigned word) {
    image.push_back(static_cast<std::uint8_t>(word & 0xffU));
    image.push_back(static_cast<std::uint8_t>(word >> 8U & 0xffU));
  };
  put_word(0x08aa);
  for (int reserved = 0; reserved < 8; ++reserved) put_word(0);
  put_word(0x003f);  // entry point
  put_word(0x8000);
  for (int block = 0; block < blocks; ++block) {
    const unsigned words = 1 + static_cast<unsigned>(random()) % 400;
    put_word(words);
    put_word(0x003f);
    put_word(0x8000 + 400 * static_cast<unsigned>(block));
    for (unsigned i = 0; i < words; ++i) put_word(static_cast<unsigned>(random()) & 0xffffU);
  }
  put_word(0);
  return image;
}

}  // namespace thimble::test
