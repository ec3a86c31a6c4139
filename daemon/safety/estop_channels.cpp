#include "daemon/safety/estop_channels.hpp"

#include <algorithm>

namespace thimble::safety {

void EstopChannels::step(std::span<const bool> is_closed, MonotonicTime now) noexcept {
  const auto mine = is_closed.first(std::min(channels_, is_closed.size()));
  const auto closed = static_cast<std::size_t>(std::count(mine.begin(), mine.end(), true));
  is_open_ = closed < channels_;
  if (closed == 0) has_disagreed_ = false;
  const bool is_disagreeing = closed > 0 && closed < channels_;
  if (!is_disagreeing) {
    disagree_since_.reset();
    return;
  }
  if (!disagree_since_) disagree_since_ = now;
  if (now - *disagree_since_ > kDisagreement) has_disagreed_ = true;
}

}  // namespace thimble::safety
