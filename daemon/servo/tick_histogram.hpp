#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

struct TickQuantiles {
  Duration p50{};
  Duration p99{};
  Duration max{};
};

// Distribution of a duration over all ticks, in buckets of 1/16 octave (6 % wide).
//
// Thread: add() from one thread; quantiles() from any, at any time (it may then see a count
// that is a few ticks old, never a torn one).
// RT: add() is THIMBLE_RT: one load and one store, no read-modify-write.
class TickHistogram {
 public:
  THIMBLE_RT void add(Duration value) noexcept {
    const auto ns = static_cast<std::uint64_t>(value.count() > 0 ? value.count() : 0);
    std::atomic<std::uint64_t>& bucket = buckets_[index_of(ns)];
    bucket.store(bucket.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    if (ns > max_ns_.load(std::memory_order_relaxed)) {
      max_ns_.store(ns, std::memory_order_relaxed);
    }
  }
  // Zeros while empty. A quantile is the upper edge of its bucket, never above the maximum.
  [[nodiscard]] TickQuantiles quantiles() const noexcept;

 private:
  static constexpr unsigned kSubBits = 4;
  static constexpr std::size_t kBuckets = 64U << kSubBits;

  // Values below 16 ns have a bucket each; above, the four bits below the leading one count.
  static constexpr std::size_t index_of(std::uint64_t ns) noexcept {
    if (ns < (1U << kSubBits)) return static_cast<std::size_t>(ns);
    const auto octave = static_cast<unsigned>(std::bit_width(ns)) - 1U;
    const std::uint64_t sub = (ns >> (octave - kSubBits)) & ((1U << kSubBits) - 1U);
    return static_cast<std::size_t>(((octave - kSubBits + 1U) << kSubBits) + sub);
  }
  static std::uint64_t upper_edge_ns(std::size_t index) noexcept;

  std::array<std::atomic<std::uint64_t>, kBuckets> buckets_{};
  std::atomic<std::uint64_t> max_ns_{0};
};

}  // namespace thimble::servo
