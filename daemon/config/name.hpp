#pragma once

#include <cstddef>
#include <string_view>

namespace thimble::config {

inline constexpr std::size_t kMaxNameBytes = 32;

// Whether an arm or a world may be called so: 1 to 32 of a-z, 0-9 and -. Pure.
[[nodiscard]] bool is_name(std::string_view text);

}  // namespace thimble::config
