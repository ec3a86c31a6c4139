#include "daemon/servo/flight_recorder.hpp"

#include <algorithm>

#include "hal/base/check.hpp"

namespace thimble::servo {

FlightRecorder::FlightRecorder(std::size_t frames) {
  THIMBLE_CHECK(frames > 0);
  for (Memory& memory : memories_) memory.frames.resize(frames);
}

// One look at the flag decides of both, frame and stop: a memory given back between two looks would
// freeze without a frame.
void FlightRecorder::freeze(const ServoFrame& last, const Fault& cause) noexcept {
  Memory& memory = memories_[writing_];
  if (memory.is_frozen.load(std::memory_order_acquire)) {
    without_room_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  memory.keep(last);
  memory.cause = cause;
  memory.is_frozen.store(true, std::memory_order_release);
  writing_ = 1 - writing_;
}

FlightStop FlightRecorder::take() {
  if (!is_frozen()) return {};
  Memory& memory = memories_[reading_];
  const std::size_t room = memory.frames.size();
  const auto kept = static_cast<std::size_t>(std::min<std::uint64_t>(memory.count, room));
  FlightStop out;
  out.cause = memory.cause;
  out.without_room = without_room_.exchange(0, std::memory_order_relaxed);
  out.frames.reserve(kept);
  for (std::uint64_t i = memory.count - kept; i < memory.count; ++i) {
    out.frames.push_back(memory.frames[static_cast<std::size_t>(i % room)]);
  }
  memory.count = 0;
  memory.is_frozen.store(false, std::memory_order_release);
  reading_ = 1 - reading_;
  return out;
}

}  // namespace thimble::servo
