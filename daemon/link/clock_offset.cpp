#include "daemon/link/clock_offset.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::link {
namespace {

Duration drift_over(Duration span) noexcept {
  return Duration(std::llround(ClockOffset::kMaxDrift_ratio * static_cast<double>(span.count())));
}

}  // namespace

void ClockOffset::note(const Exchange& exchange) noexcept {
  const Duration there = exchange.arrived - exchange.sent;
  const Duration back = exchange.came_back - exchange.answered;
  const Duration slack = drift_over(kWindow);
  const bool is_possible = exchange.came_back >= exchange.sent &&
                           exchange.answered >= exchange.arrived && there + back >= -slack;
  const std::int64_t number = exchange.came_back.since_epoch / kSlot;
  if (newest_ && number < *newest_) return;  // told late: its slot may be another's
  if (!is_possible) return reset();
  if (newest_) {
    // Ways that together are shorter than nothing: since then a clock was set.
    const Least known = least();
    if (known.there + back < -slack || there + known.back < -slack) reset();
  }
  there_ = newest_ ? there_ + (there - there_) / 8 : there;
  back_ = newest_ ? back_ + (back - back_) / 8 : back;
  Least& slot = slots_[static_cast<std::size_t>(number) % kSlots];
  if (slot.number != number) slot = {.number = number};
  slot.there = std::min(slot.there, there);
  slot.back = std::min(slot.back, back);
  newest_ = number;
}

ClockOffset::Least ClockOffset::least() const noexcept {
  Least out;
  for (const Least& slot : slots_) {
    if (slot.number < 0 || slot.number <= *newest_ - static_cast<std::int64_t>(kSlots)) continue;
    out.there = std::min(out.there, slot.there);
    out.back = std::min(out.back, slot.back);
  }
  return out;
}

Duration ClockOffset::offset() const noexcept {
  if (!newest_) return {};
  const Least known = least();
  return (known.there - known.back) / 2;
}

Duration ClockOffset::error() const noexcept {
  if (!newest_) return {};
  const Least known = least();
  const Duration ways = std::max((known.there + known.back) / 2, Duration::zero());
  return ways + drift_over(kWindow) + Duration(1);  // what the halving rounds
}

ClockStatus ClockOffset::status() const noexcept {
  return {.offset = offset(),
          .offset_error = error(),
          .way_there = way_there(),
          .way_back = way_back()};
}

Duration ClockOffset::way_there() const noexcept {
  if (!newest_) return {};
  return std::max(there_ - offset(), Duration::zero());
}

Duration ClockOffset::way_back() const noexcept {
  if (!newest_) return {};
  return std::max(back_ + offset(), Duration::zero());
}

}  // namespace thimble::link
