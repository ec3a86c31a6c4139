#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

#include "hal/rt/annotations.hpp"

namespace thimble::rt {

// Latest value from one writer thread to one reader thread. Both sides are wait-free; the
// reader never sees a torn value and never waits; older values are overwritten unread.
//
// Thread: write() from exactly one thread, read() from exactly one other.
// RT: all THIMBLE_RT: one copy of T and one atomic exchange.
// Ownership: holds three copies of T; no allocation.
template <class T>
class TripleBuffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  TripleBuffer() = default;
  TripleBuffer(const TripleBuffer&) = delete;
  TripleBuffer& operator=(const TripleBuffer&) = delete;

  THIMBLE_RT void write(const T& value) noexcept {
    slots_[write_index_].value = value;
    const std::uint8_t previous = middle_.exchange(static_cast<std::uint8_t>(write_index_ | kFresh),
                                                   std::memory_order_acq_rel);
    write_index_ = previous & kIndexMask;
  }

  // Reader's thread: read() would find something. Nothing is taken.
  THIMBLE_RT [[nodiscard]] bool has_news() const noexcept {
    return (middle_.load(std::memory_order_relaxed) & kFresh) != 0;
  }

  // True and `out` set when something was written since the last read(); else `out` untouched.
  THIMBLE_RT bool read(T& out) noexcept {
    if (!has_news()) return false;
    const std::uint8_t previous = middle_.exchange(read_index_, std::memory_order_acq_rel);
    read_index_ = previous & kIndexMask;
    out = slots_[read_index_].value;
    return true;
  }

 private:
  static constexpr std::uint8_t kFresh = 0x80;
  static constexpr std::uint8_t kIndexMask = 0x03;
  struct alignas(64) Slot {  // own cache line each: the two sides must not share one
    T value{};
  };

  std::array<Slot, 3> slots_{};
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t write_index_{0};
  alignas(64) std::uint8_t read_index_{2};
};

}  // namespace thimble::rt
