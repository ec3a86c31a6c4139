#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thimble::doctor {

// One entry of an access control list as the kernel stores it.
struct PlantedEntry {
  std::uint32_t tag{0};
  std::uint32_t rights{0};
  std::uint32_t id{0xFFFFFFFF};  // of a named user or group
};

// What logind gives the user of the seat: rw for owner, user 1000, group and mask.
inline const std::vector<PlantedEntry> kListOfASeat{
    {0x01, 06}, {0x02, 06, 1000}, {0x04, 06}, {0x10, 06}, {0x20, 0}};

inline std::vector<std::byte> access_list_bytes(const std::vector<PlantedEntry>& entries,
                                                std::uint32_t version = 2) {
  std::vector<std::byte> bytes;
  const auto put = [&](std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
  };
  put(version, 4);
  for (const PlantedEntry& entry : entries) {
    put(entry.tag, 2);
    put(entry.rights, 2);
    put(entry.id, 4);
  }
  return bytes;
}

}  // namespace thimble::doctor
