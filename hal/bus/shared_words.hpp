#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace thimble::bus {

// Memory that a host and a board have in common, as words of 32 bits by byte offset: a view.
//
// Each word is loaded and stored whole; a store is seen after the stores before it, a load is done
// before the loads after it. So nobody needs a fence, which ThreadSanitizer does not model.
//
// Thread: any. RT: no call, no wait. Ownership: none. Errors: none; offsets that are not aligned or
// not within are mistakes of the caller.
class SharedWords {
  static_assert(std::endian::native == std::endian::little, "the lowest byte comes first");

 public:
  SharedWords() noexcept = default;
  explicit SharedWords(std::span<std::uint32_t> words) noexcept : words_(words) {}

  [[nodiscard]] std::size_t bytes() const noexcept { return words_.size_bytes(); }
  // A part of it, with offsets of its own.
  [[nodiscard]] SharedWords from(std::uint32_t offset, std::size_t bytes) const noexcept {
    constexpr std::size_t kWordBytes = sizeof(std::uint32_t);
    return SharedWords(words_.subspan(offset / kWordBytes, bytes / kWordBytes));
  }
  [[nodiscard]] std::uint32_t load(std::uint32_t offset) const noexcept {
    return __atomic_load_n(&words_[offset / sizeof(std::uint32_t)], __ATOMIC_ACQUIRE);
  }
  void store(std::uint32_t offset, std::uint32_t value) const noexcept {
    __atomic_store_n(&words_[offset / sizeof(std::uint32_t)], value, __ATOMIC_RELEASE);
  }

 private:
  std::span<std::uint32_t> words_;
};

}  // namespace thimble::bus
