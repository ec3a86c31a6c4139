#include "daemon/servo/flight_recorder.hpp"

#include <algorithm>

#include "hal/base/check.hpp"

namespace thimble::servo {

FlightRecorder::FlightRecorder(std::size_t frames) : frames_(frames) { THIMBLE_CHECK(frames > 0); }

std::vector<ServoFrame> FlightRecorder::take() {
  if (!is_frozen()) return {};
  const auto kept = static_cast<std::size_t>(std::min<std::uint64_t>(count_, frames_.size()));
  std::vector<ServoFrame> out;
  out.reserve(kept);
  for (std::uint64_t i = count_ - kept; i < count_; ++i) {
    out.push_back(frames_[static_cast<std::size_t>(i % frames_.size())]);
  }
  count_ = 0;
  is_frozen_.store(false, std::memory_order_release);
  return out;
}

}  // namespace thimble::servo
