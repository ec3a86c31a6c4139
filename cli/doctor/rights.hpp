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
// By the permission bits; an access control list may grant more.
[[nodiscard]] bool may_read_and_write(const Process& process, const Node& node) noexcept;

}  // namespace thimble::doctor
