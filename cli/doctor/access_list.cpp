#include "cli/doctor/access_list.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace thimble::doctor {
namespace {

// POSIX_ACL_XATTR_VERSION and the sizes of struct posix_acl_xattr_header and …_entry.
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kHeaderBytes = 4;
constexpr std::size_t kEntryBytes = 8;
// ACL_… of linux/posix_acl.h.
constexpr std::uint32_t kOwner = 0x01;
constexpr std::uint32_t kNamedUser = 0x02;
constexpr std::uint32_t kGroup = 0x04;
constexpr std::uint32_t kNamedGroup = 0x08;
constexpr std::uint32_t kMask = 0x10;
constexpr std::uint32_t kOthers = 0x20;
constexpr std::uint32_t kAllRights = 07;

struct Entry {
  std::uint32_t tag{0};
  std::uint32_t rights{0};
  std::uint32_t id{0};
};

std::uint32_t little_endian(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) {
    value = value << 8U | std::to_integer<std::uint32_t>(bytes[i - 1]);
  }
  return value;
}

Entry entry_of(std::span<const std::byte> bytes) {
  return {little_endian(bytes.first(2)), little_endian(bytes.subspan(2, 2)),
          little_endian(bytes.subspan(4, 4))};
}

bool is_known(const Entry& entry) {
  constexpr std::uint32_t kTags = kOwner | kNamedUser | kGroup | kNamedGroup | kMask | kOthers;
  const bool is_one_tag = entry.tag != 0 && (entry.tag & (entry.tag - 1)) == 0;
  return is_one_tag && (entry.tag & ~kTags) == 0 && entry.rights <= kAllRights;
}

}  // namespace

std::optional<AccessList> parse_access_list(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeaderBytes || (bytes.size() - kHeaderBytes) % kEntryBytes != 0) {
    return std::nullopt;
  }
  if (little_endian(bytes.first(kHeaderBytes)) != kVersion) return std::nullopt;
  std::uint32_t mask = kAllRights;
  std::optional<std::uint32_t> group;
  std::vector<Entry> named;
  for (auto rest = bytes.subspan(kHeaderBytes); !rest.empty(); rest = rest.subspan(kEntryBytes)) {
    const Entry entry = entry_of(rest.first(kEntryBytes));
    if (!is_known(entry)) return std::nullopt;
    if (entry.tag == kMask) mask = entry.rights;
    if (entry.tag == kGroup) group = entry.rights;
    if (entry.tag == kNamedUser || entry.tag == kNamedGroup) named.push_back(entry);
  }
  AccessList list;
  // acl_permission_check() of the kernel looks at no list whose mask is empty, so that a user whom
  // it names is everybody else again.
  if (mask == 0) named.clear();
  if (group) list.group_rights = *group & mask;
  for (const Entry& entry : named) {
    (entry.tag == kNamedUser ? list.users : list.groups).push_back({entry.id, entry.rights & mask});
  }
  return list;
}

}  // namespace thimble::doctor
