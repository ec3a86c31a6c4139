#pragma once

#include <cstdint>

namespace thimble::test {

// Allocations made by the calling thread through operator new since it started. Linking this
// replaces the global operators: malloc() called directly is not seen.
std::uint64_t allocation_count() noexcept;

// Bytes that the calling thread has by operator new, less those that it gave back; the allocator's
// rounding is in them.
std::int64_t allocated_bytes() noexcept;
// The most of them since the thread began, or since it said that it begins anew.
std::int64_t most_allocated_bytes() noexcept;
void begin_most_allocated_bytes() noexcept;

}  // namespace thimble::test
