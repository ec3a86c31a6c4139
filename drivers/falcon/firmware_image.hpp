#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/base/result.hpp"

namespace thimble::falcon {

// The firmware that a person brings: its vendor's licence forbids to ship it.
// Thread: any non-RT one, several at once: each arm reads its file in its own.

// Ours: eight times the largest known.
inline constexpr std::size_t kMaxImageBytes = 64UL * 1024;

// In hexadecimal, small letters. Any bytes.
[[nodiscard]] std::string sha256_of(std::span<const std::uint8_t> bytes);

// The image in the file at `path`, when it is the one that was meant: its sha256 is `sha256` (64
// hexadecimal digits), or where that is empty, one of wire::kKnownImages.
// NotFound, Permission: there is no such file, or none that may be read, and the message says how
// to get one; TooLarge; Malformed for what is no image or another one; InvalidArgument for a
// `sha256` that cannot be.
[[nodiscard]] Result<std::vector<std::uint8_t>> load_image(const std::string& path,
                                                           const std::string& sha256);

}  // namespace thimble::falcon
