#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/cambus/step_list.hpp"

namespace thimble::cambus {

// Where a list puts what it reads: offset in the window, and how many words.
struct ReadSlot {
  std::uint32_t offset{0};
  std::uint32_t words{0};
};

// Puts steps one behind the other, each followed by its buffer, and links them. What waits for the
// end of a scan does so; data of two words by turns becomes immediate. What comes out is a list
// that check_step_list() takes, unless a port was asked for more than it has. Thread: one at a
// time. Errors: none; calls with a length of 0 are mistakes of the caller.
class StepListBuilder {
 public:
  // `base`: offset in the window at which the list will lie, a multiple of 16, and not 0.
  explicit StepListBuilder(std::uint32_t base = wire::kReservedBytes);

  void write(const RegisterWords& words);
  // To a port, or to `event`: as many words as are given. After scan-io comes its delay.
  void write_port(Register port, std::span<const std::uint16_t> words);
  // Of a register of fixed length, `words` are its bits.
  ReadSlot read(Register number, std::uint32_t words);
  void delay(std::uint32_t clocks);
  // Drives the reset line: every register but a few becomes 0 (docs/cambus.md, section 2).
  void reset(std::uint32_t clocks);
  // On the step written last.
  void raise_interrupt();

  // Ends it with a stop; an empty list becomes a delay of one clock. The builder is empty again.
  [[nodiscard]] StepList finish();

 private:
  std::uint32_t window_offset(std::size_t place) const;
  void store_word(std::size_t place, std::uint32_t value);
  void begin_step(std::uint32_t opcode, std::uint32_t length);
  void add_buffer(std::uint32_t bytes);
  void flag_last(std::uint32_t flag);

  std::uint32_t base_;
  std::size_t last_step_{0};  // where in bytes_, unless these are empty
  std::vector<std::uint8_t> bytes_;
};

}  // namespace thimble::cambus
