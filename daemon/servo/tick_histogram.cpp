#include "daemon/servo/tick_histogram.hpp"

#include <algorithm>

namespace thimble::servo {

std::uint64_t TickHistogram::upper_edge_ns(std::size_t index) noexcept {
  if (index < (1U << kSubBits)) return index;
  const auto octave = static_cast<unsigned>(index >> kSubBits) + kSubBits - 1U;
  const std::uint64_t sub = index & ((1U << kSubBits) - 1U);
  const std::uint64_t width = std::uint64_t{1} << (octave - kSubBits);
  return (std::uint64_t{1} << octave) + (sub + 1) * width - 1;
}

TickQuantiles TickHistogram::quantiles() const noexcept {
  std::array<std::uint64_t, kBuckets> counts{};
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < kBuckets; ++i) {
    counts[i] = buckets_[i].load(std::memory_order_relaxed);
    total += counts[i];
  }
  const std::uint64_t max_ns = max_ns_.load(std::memory_order_relaxed);
  if (total == 0) return {};
  const auto quantile = [&](std::uint64_t percent) {
    const std::uint64_t rank = (total * percent + 99) / 100;  // at least 1
    std::uint64_t seen = counts[0];
    std::size_t i = 0;
    while (seen < rank) seen += counts[++i];
    return Duration(static_cast<std::int64_t>(std::min(upper_edge_ns(i), max_ns)));
  };
  return {quantile(50), quantile(99), Duration(static_cast<std::int64_t>(max_ns))};
}

}  // namespace thimble::servo
