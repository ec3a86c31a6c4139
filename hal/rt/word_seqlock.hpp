#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "hal/rt/annotations.hpp"

namespace thimble::rt {

// Latest value from one writer to any number of readers. The writer is wait-free; readers
// retry while a write is under way, so the writer must be the higher priority: servo writes,
// net plane reads, never the other way round.
//
// The payload lives in atomic words, each stored with release and loaded with acquire, so
// that no fence is needed: ThreadSanitizer does not model fences, and a plain copy is a race.
//
// Thread: store() from one thread; load() from any.
// RT: store() THIMBLE_RT; load() is bounded by `attempts` and may fail.
template <class T>
class WordSeqlock {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  THIMBLE_RT void store(const T& value) noexcept {
    const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    // A reader that sees any new word (acquire) also sees this odd number (sequenced before).
    sequence_.store(sequence + 1, std::memory_order_relaxed);
    const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
    for (std::size_t i = 0; i < kWholeWords; ++i) store_word(i, bytes + 8 * i, 8);
    if constexpr (kTailBytes != 0) store_word(kWholeWords, bytes + 8 * kWholeWords, kTailBytes);
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  // False (and `out` untouched) when every attempt met a write under way.
  [[nodiscard]] bool load(T& out, int attempts = 1000) const noexcept {
    std::array<std::uint64_t, kWords> words{};
    while (attempts-- > 0) {
      const std::uint64_t before = sequence_.load(std::memory_order_acquire);
      if (before % 2 != 0) continue;
      for (std::size_t i = 0; i < kWords; ++i) words[i] = words_[i].load(std::memory_order_acquire);
      if (sequence_.load(std::memory_order_relaxed) != before) continue;
      std::memcpy(static_cast<void*>(&out), words.data(), sizeof(T));
      return true;
    }
    return false;
  }

 private:
  static constexpr std::size_t kWholeWords = sizeof(T) / 8;
  static constexpr std::size_t kTailBytes = sizeof(T) % 8;

  void store_word(std::size_t index, const std::byte* bytes, std::size_t size) noexcept {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, size);
    words_[index].store(word, std::memory_order_release);
  }

  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;
  alignas(64) std::atomic<std::uint64_t> sequence_{0};
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace thimble::rt
