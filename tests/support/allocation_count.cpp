#include "tests/support/allocation_count.hpp"

#include <malloc.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

thread_local std::uint64_t count = 0;
thread_local std::int64_t bytes = 0;
thread_local std::int64_t most_bytes = 0;

void take(void* memory) noexcept {
  bytes += static_cast<std::int64_t>(::malloc_usable_size(memory));
  most_bytes = std::max(most_bytes, bytes);
}

void give_back(void* memory) noexcept {
  bytes -= static_cast<std::int64_t>(::malloc_usable_size(memory));
  std::free(memory);
}

void* counted_or_null(std::size_t size, std::size_t alignment) {
  ++count;
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  void* const memory = alignment <= alignof(std::max_align_t)
                           ? std::malloc(size == 0 ? 1 : size)
                           : std::aligned_alloc(alignment, rounded);
  take(memory);
  return memory;
}

void* counted(std::size_t size, std::size_t alignment) {
  void* memory = counted_or_null(size, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

namespace thimble::test {
std::uint64_t allocation_count() noexcept { return count; }
std::int64_t allocated_bytes() noexcept { return bytes; }
std::int64_t most_allocated_bytes() noexcept { return most_bytes; }
void begin_most_allocated_bytes() noexcept { most_bytes = bytes; }
}  // namespace thimble::test

void* operator new(std::size_t size) { return counted(size, 1); }
void* operator new[](std::size_t size) { return counted(size, 1); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
// Shared objects that are loaded use these too, and delete with the ones below.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return counted_or_null(size, 1);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return counted_or_null(size, 1);
}
void operator delete(void* memory) noexcept { give_back(memory); }
void operator delete[](void* memory) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { give_back(memory); }
void operator delete[](void* memory, std::size_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give_back(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { give_back(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { give_back(memory); }
