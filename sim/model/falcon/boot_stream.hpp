#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// Reads a boot stream of the processor's maker byte by byte, as its boot ROM does: 16-bit words,
// the low byte first: the key 0x08aa; eight reserved words; the entry point (2 words); then blocks
// of a size in words, an address (2 words) and so many words of data; a block of size 0 ends it.
// Source: Texas Instruments, boot ROM guides of the TMS320C28x ("Bootloader Data Stream
// Structure"); that the 2811 of this arm reads the same form is what its key tells.
// What is loaded is not kept: a model of the code's meaning is another thing than its bytes.
//
// Thread: one. RT: all. Errors: Refused, for ever, when the key is another.
class BootStream {
 public:
  enum class State : std::uint8_t { Reading, Complete, Refused };

  // Nothing happens once it is complete or refused.
  THIMBLE_RT void take(std::uint8_t byte) noexcept;
  [[nodiscard]] State state() const noexcept { return state_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  enum class Part : std::uint8_t { Head, Size, Address, Data };
  THIMBLE_RT void take_word(std::uint16_t word) noexcept;

  State state_{State::Reading};
  Part part_{Part::Head};
  std::size_t bytes_{0};
  std::uint8_t low_{0};
  std::uint16_t block_words_{0};
  std::size_t words_in_part_{0};
};

}  // namespace thimble::sim
