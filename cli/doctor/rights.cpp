#include "cli/doctor/rights.hpp"

#include <algorithm>

namespace thimble::doctor {

bool is_in_group(const Process& process, std::uint32_t group) noexcept {
  return std::find(process.groups.begin(), process.groups.end(), group) != process.groups.end();
}

bool may(const Process& process, const Node& node, std::uint32_t rights) noexcept {
  const auto grants = [rights](std::uint32_t given) { return (given & rights) == rights; };
  if (has_capability(process, kCapDacOverride)) return true;
  // The first class that fits decides, even where a later one would grant more.
  if (process.user == node.user) return grants(node.mode >> 6U);
  for (const AccessEntry& entry : node.access_list.users) {
    if (entry.id == process.user) return grants(entry.rights);
  }
  // Among groups, one that grants all of it is enough.
  bool is_any_group = is_in_group(process, node.group);
  if (is_any_group && grants(node.mode >> 3U)) return true;
  for (const AccessEntry& entry : node.access_list.groups) {
    if (!is_in_group(process, entry.id)) continue;
    if (grants(entry.rights)) return true;
    is_any_group = true;
  }
  return !is_any_group && grants(node.mode);
}

}  // namespace thimble::doctor
