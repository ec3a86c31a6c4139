#include "cli/doctor/rights.hpp"

#include <algorithm>

namespace thimble::doctor {

bool is_in_group(const Process& process, std::uint32_t group) noexcept {
  return std::find(process.groups.begin(), process.groups.end(), group) != process.groups.end();
}

bool may_read_and_write(const Process& process, const Node& node) noexcept {
  if (has_capability(process, kCapDacOverride)) return true;
  // The first class that fits decides, even where a later one would grant more.
  const unsigned shift = process.user == node.user ? 6 : is_in_group(process, node.group) ? 3 : 0;
  return (node.mode >> shift & 06U) == 06U;
}

}  // namespace thimble::doctor
