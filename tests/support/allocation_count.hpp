#pragma once

#include <cstdint>

namespace thimble::test {

// Allocations made by the calling thread through operator new since it started. Linking this
// replaces the global operators: malloc() called directly is not seen.
std::uint64_t allocation_count() noexcept;

}  // namespace thimble::test
