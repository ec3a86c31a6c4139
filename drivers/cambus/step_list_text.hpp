#pragma once

#include <cstdint>
#include <string>

#include "drivers/cambus/step_list.hpp"

namespace thimble::cambus {

// A list in words, a line for each step and more where layers differ:
//
//   0x10  write kick, wait: amount 0x1
//   0x40  write run, wait: layers 0-3 sync 3; layers 4-15 0
//   0x50  read event, 25 words to 0x60; stop
//
// Fields of 0 are left out. Pure and total: where the list leaves the window, or comes back to a
// step, the last line says so. Whether a board would take it says check_step_list().
[[nodiscard]] std::string disassemble(const WindowView& window, std::uint32_t head);

}  // namespace thimble::cambus
