#include "daemon/safety/estop_channels.hpp"

#include <algorithm>

namespace thimble::safety {

std::size_t EstopChannels::count_closed(std::span<const bool> is_closed) const noexcept {
  const auto mine = is_closed.first(std::min(channels_, is_closed.size()));
  return static_cast<std::size_t>(std::count(mine.begin(), mine.end(), true));
}

void EstopChannels::step(std::span<const bool> is_closed) noexcept {
  is_open_ = count_closed(is_closed) < channels_;
}

void EstopChannels::compare(std::span<const bool> is_read_closed, MonotonicTime read_at) noexcept {
  const std::size_t closed = count_closed(is_read_closed);
  if (closed == 0) has_disagreed_ = false;
  const bool is_disagreeing = closed > 0 && closed < channels_;
  if (!is_disagreeing) {
    disagree_since_.reset();
    return;
  }
  if (!disagree_since_) disagree_since_ = read_at;
  if (read_at - *disagree_since_ > kDisagreement) has_disagreed_ = true;
}

}  // namespace thimble::safety
