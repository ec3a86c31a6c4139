#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "cli/doctor/facts.hpp"

namespace thimble::doctor {

// What the bytes of the extended attribute "system.posix_acl_access" say, its mask applied: the
// form is that of linux/posix_acl_xattr.h, numbers in little endian. Total: whatever is no such
// list of known entries is nothing. Thread: any. Not RT. Pure.
[[nodiscard]] std::optional<AccessList> parse_access_list(std::span<const std::byte> bytes);

}  // namespace thimble::doctor
