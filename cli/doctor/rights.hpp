#pragma once

#include <cstdint>

#include "cli/doctor/facts.hpp"

// What the kernel lets a process do. Thread: any. Not RT. Pure.
namespace thimble::doctor {

// Numbers of linux/capability.h.
inline constexpr unsigned kCapDacOverride = 1;
inline constexpr unsigned kCapIpcLock = 14;
inline constexpr unsigned kCapSysNice = 23;

[[nodiscard]] inline bool has_capability(const Process& process, unsigned capability) noexcept {
  return (process.capabilities >> capability & 1U) != 0;
}
[[nodiscard]] bool is_in_group(const Process& process, std::uint32_t group) noexcept;
// Of a node: as the kernel weighs permission bits and access control lists, acl(5).
inline constexpr std::uint32_t kRead = 04;
inline constexpr std::uint32_t kWrite = 02;
[[nodiscard]] bool may(const Process& process, const Node& node, std::uint32_t rights) noexcept;

}  // namespace thimble::doctor
