#pragma once

#include <cstdint>

#include "drivers/cambus/step_list.hpp"
#include "hal/base/result.hpp"

namespace thimble::cambus {

// What the board is like that a list is meant for.
struct ListLimits {
  std::uint32_t module_sites{1U << 22};
  bool has_sync{false};  // sync pulses run: frame- and line-synchronised scans come to an end
};

struct ListSummary {
  std::uint32_t steps{0};
  std::uint32_t runs{0};  // writes to the run register
  std::uint32_t reads{0};
  std::uint64_t words{0};  // moved, once through
  bool loops{false};       // ends only when the host gives another list
  bool operator==(const ListSummary&) const = default;
};

// Follows a list from `head` as a board would and refuses what would hang it, overrun a buffer,
// destroy the list, disturb a running scan, or use registers, bits or codes that mean nothing:
// docs/cambus.md, end of section 3. Pure and total: any bytes give a summary or a reason.
// What modules a read selects is not looked at.
// Errors: Malformed, TooLarge; the message says at which step.
[[nodiscard]] Result<ListSummary> check_step_list(const WindowView& window, std::uint32_t head,
                                                  const ListLimits& limits = {});

}  // namespace thimble::cambus
