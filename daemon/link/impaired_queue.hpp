#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "daemon/link/impairment.hpp"

namespace thimble::link {

// Messages of one direction of a link on their way: each lost, doubled, held back and
// delayed as the dice say. Without impairment it hands over in order and at once.
//
// Thread: one. RT: not for the servo; allocates only while its high-water mark rises.
// Ownership: holds copies of T. Errors: when full the newest message is refused and counted.
template <class T, std::size_t Capacity = 8192>  // 1 s one way at 8 kHz
class ImpairedQueue {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  ImpairedQueue(const ImpairmentSettings& settings, std::uint64_t direction)
      : dice_(settings, direction) {}

  void push(MonotonicTime now, const T& message) {
    const ImpairmentDice::Fate fate = dice_.draw();
    if (fate.is_lost) {
      ++counters_.lost;
      return;
    }
    MonotonicTime due = std::max(now + fate.delay, newest_due_);
    if (fate.is_held_back) {
      due = due + ImpairmentSettings::kReorderHold;
      ++counters_.reordered;
    } else {
      newest_due_ = due;
    }
    if (!enqueue(due, message)) return;
    if (fate.is_duplicated && enqueue(due, message)) ++counters_.duplicated;
  }

  // True and `out` set when a message is due; call until false.
  bool pop_due(MonotonicTime now, T& out) {
    if (heap_.empty() || heap_.front().due > now) return false;
    std::pop_heap(heap_.begin(), heap_.end(), later);
    const std::size_t slot = heap_.back().slot;
    heap_.pop_back();
    out = slots_[slot];
    free_.push_back(slot);
    return true;
  }

  [[nodiscard]] std::optional<MonotonicTime> next_due() const noexcept {
    if (heap_.empty()) return std::nullopt;
    return heap_.front().due;
  }

  void clear() noexcept {
    heap_.clear();
    slots_.clear();
    free_.clear();
    newest_due_ = {};
  }

  [[nodiscard]] const ImpairmentCounters& counters() const noexcept { return counters_; }

 private:
  struct Key {
    MonotonicTime due{};
    std::uint64_t order{0};
    std::size_t slot{0};
  };
  static bool later(const Key& a, const Key& b) noexcept {
    return a.due != b.due ? a.due > b.due : a.order > b.order;
  }

  bool enqueue(MonotonicTime due, const T& message) {
    if (heap_.size() == Capacity) {
      ++counters_.overflowed;
      return false;
    }
    std::size_t slot = slots_.size();
    if (free_.empty()) {
      slots_.push_back(message);
    } else {
      slot = free_.back();
      free_.pop_back();
      slots_[slot] = message;
    }
    heap_.push_back({due, ++order_, slot});
    std::push_heap(heap_.begin(), heap_.end(), later);
    return true;
  }

  ImpairmentDice dice_;
  ImpairmentCounters counters_{};
  MonotonicTime newest_due_{};
  std::uint64_t order_{0};
  std::vector<Key> heap_;
  std::vector<T> slots_;
  std::vector<std::size_t> free_;
};

}  // namespace thimble::link
