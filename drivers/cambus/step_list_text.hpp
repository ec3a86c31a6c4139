#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "drivers/cambus/step_list.hpp"

namespace thimble::cambus {

// Ours: more than anybody reads, and little beside a machine's memory.
inline constexpr std::size_t kMostTextBytes = std::size_t{64} << 20;

// A list in words, a line for each step and more where layers differ:
//
//   0x10  write kick, wait: amount 0x1
//   0x40  write run, wait: layers 0-3 sync 3; layers 4-15 0
//   0x50  read event, 25 words to 0x60; stop
//
// Fields of 0 are left out. Pure and total: where the list leaves the window, or comes back to a
// step, the last line says so; likewise where the text would have more than `most_bytes` before it:
// steps may share one buffer, so that a list can be told in some 170 times its bytes. Whether a
// board would take it says check_step_list().
[[nodiscard]] std::string disassemble(const WindowView& window, std::uint32_t head,
                                      std::size_t most_bytes = kMostTextBytes);

}  // namespace thimble::cambus
