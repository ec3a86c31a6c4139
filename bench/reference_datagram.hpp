#pragma once

#include <cstddef>

// Plain code, without project headers.

// Copies `size` bytes out and back, `times` times; a sum that keeps the copies.
[[nodiscard]] unsigned reference_copies(std::size_t size, int times);

// Seals and opens `size` bytes with libsodium's ChaCha20-Poly1305, `times` times; how often it
// opened.
[[nodiscard]] int reference_seals(std::size_t size, int times);
