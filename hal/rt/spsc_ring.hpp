#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hal/rt/annotations.hpp"

namespace thimble::rt {

// Ordered events from one writer to one reader. When full, the newest is refused and
// counted: nothing already promised to the reader is lost.
//
// Thread: push() from one thread, pop() and peek() from one other; refused() from any.
// RT: these three THIMBLE_RT. Holds `Capacity` copies of T; no allocation.
template <class T, std::size_t Capacity>
class SpscRing {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(std::has_single_bit(Capacity), "a power of two, so that indices may wrap");

 public:
  THIMBLE_RT bool push(const T& value) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == Capacity) {
      refused_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    slots_[head % Capacity] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  THIMBLE_RT bool pop(T& out) noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    out = slots_[tail % Capacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  // The one that comes behind `nth` others, 0 the next; valid until it is popped. nullptr: none.
  THIMBLE_RT [[nodiscard]] const T* peek(std::size_t nth) const noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (head_.load(std::memory_order_acquire) - tail <= nth) return nullptr;
    return &slots_[(tail + nth) % Capacity];
  }

  [[nodiscard]] std::uint64_t refused() const noexcept {
    return refused_.load(std::memory_order_relaxed);
  }

 private:
  std::array<T, Capacity> slots_{};
  alignas(64) std::atomic<std::uint64_t> head_{0};
  alignas(64) std::atomic<std::uint64_t> tail_{0};
  std::atomic<std::uint64_t> refused_{0};
};

}  // namespace thimble::rt
