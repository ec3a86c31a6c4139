#include "daemon/link/outstanding_requests.hpp"

#include <algorithm>

namespace thimble::link {

void OutstandingRequests::on_sent(MonotonicTime now) noexcept {
  if (size_ == kCapacity) {
    drop_oldest();
    ++lost_;
  }
  sent_at_[(oldest_ + size_) % kCapacity] = now;
  ++size_;
}

std::optional<Duration> OutstandingRequests::on_reply(MonotonicTime now) noexcept {
  expire(now);
  if (size_ == 0) {
    shortest_.reset();
    is_resynchronised_ = false;
    return std::nullopt;
  }
  const Duration age = now - sent_at_[oldest_];
  drop_oldest();
  if (!shortest_ || (!is_resynchronised_ && age < *shortest_)) shortest_ = age;
  return age;
}

void OutstandingRequests::expire(MonotonicTime now) noexcept {
  if (size_ == 0 || now - sent_at_[oldest_] <= limit()) return;
  drop_older_than(now - shortest_.value_or(kUnknownLimit));
  is_resynchronised_ = shortest_.has_value();
}

void OutstandingRequests::drop_all() noexcept {
  lost_ += size_;
  size_ = 0;
}

void OutstandingRequests::forget() noexcept {
  drop_all();
  shortest_.reset();
  is_resynchronised_ = false;
}

Duration OutstandingRequests::limit() const noexcept {
  return shortest_ ? std::max(3 * *shortest_, *shortest_ + kSlack) : kUnknownLimit;
}

void OutstandingRequests::drop_oldest() noexcept {
  oldest_ = (oldest_ + 1) % kCapacity;
  --size_;
}

void OutstandingRequests::drop_older_than(MonotonicTime sent_at) noexcept {
  while (size_ > 0 && sent_at_[oldest_] < sent_at) {
    drop_oldest();
    ++lost_;
  }
}

}  // namespace thimble::link
