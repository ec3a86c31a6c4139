#include "drivers/phantom/zero_jump.hpp"

#include <algorithm>
#include <cstdlib>

namespace thimble::phantom {
namespace {

// In 64 bits: the counters may be any.
std::int64_t largest(const ZeroJump::Counts& a, const ZeroJump::Counts& b) noexcept {
  std::int64_t most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, std::abs(static_cast<std::int64_t>(a[i]) - b[i]));
  }
  return most;
}

}  // namespace

// With a margin for the hand that trembles.
bool ZeroJump::is_unseen_at(const Counts& counts) noexcept {
  return largest(counts, {}) < kJump_counts + kStill_counts;
}

void ZeroJump::on_counts(const Counts& counts, Duration since_last) noexcept {
  const std::int64_t step = last_ ? largest(counts, *last_) : 0;
  last_ = counts;
  if (step < kJump_counts) {
    still_for_ = step <= kStill_counts ? still_for_ + since_last : Duration(0);
    return;
  }
  is_pressed_ = still_for_ >= kStillFor && largest(counts, {}) <= kNearZero_counts;
  still_for_ = {};
}

}  // namespace thimble::phantom
