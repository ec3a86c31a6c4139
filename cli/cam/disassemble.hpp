#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "drivers/cambus/step_list_check.hpp"
#include "hal/base/result.hpp"

namespace thimble::cam {

// A list can use no more than a board's window; the largest we know has 2^24 sites of two bytes.
inline constexpr std::size_t kMaxListBytes = std::size_t{64} << 20;

struct ListReport {
  std::string text;     // each step, and what they come to where a board would take the list
  std::string refusal;  // why it would not; otherwise empty
};

// What the file of a step list says (docs/cambus.md, section 3). Pure and total.
// Errors: Malformed or TooLarge when it is no such file.
[[nodiscard]] Result<ListReport> report_list(std::string_view file,
                                             const cambus::ListLimits& limits);

// `thimble cam disassemble FILE`: writes to standard output, mistakes and a refusal to standard
// error; returns the exit code.
int run_disassemble(const std::string& file, const cambus::ListLimits& limits);

}  // namespace thimble::cam
