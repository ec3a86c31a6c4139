#include "guard/watch.hpp"

#include <algorithm>

namespace thimble::guard {

bool Watch::look(MonotonicTime now, MonotonicTime beat_at, std::uint32_t drive) noexcept {
  const bool is_first = drive_ != drive || drive == 0;
  // Another clock's: no beat. A little after `now` it may be, for that was read before.
  const bool is_possible = beat_at <= now + settings_.patience;
  const bool has_beaten = (beat_at != seen_ && is_possible) || is_first;
  seen_ = beat_at;
  drive_ = drive;
  if (has_beaten) {
    // What is older than twice the patience is as good as too old.
    last_beat_ = std::clamp(is_possible ? beat_at : now, now - 2 * settings_.patience, now);
    // The silence counts from the first force on, which came after the look before.
    if (is_first) last_beat_ = std::max(last_beat_, looked_at_.value_or(now));
    taken_since_.reset();
  }
  looked_at_ = now;
  // The force before was taken away, be there another one by now.
  if (is_first) is_letting_go_ = false;
  if (drive == 0) return false;
  if (!is_letting_go_ && now - last_beat_ > settings_.patience) {
    is_letting_go_ = true;
    ++interventions_;
  }
  return is_letting_go_ && must_write(now);
}

bool Watch::look_alone(MonotonicTime now, bool was_driven) noexcept {
  if (!was_driven) return false;
  if (!alone_since_) {
    alone_since_ = now;
    taken_since_.reset();
  }
  return now - *alone_since_ <= settings_.gives_up_after && must_write(now);
}

void Watch::wrote(MonotonicTime now, bool is_taken) noexcept {
  if (is_taken && !taken_since_) taken_since_ = now;
}

MonotonicTime Watch::next_look(MonotonicTime now) const noexcept {
  if (alone_since_ || is_letting_go_) return now + settings_.zero_every;
  if (drive_ == 0) return now + settings_.idle_look_every;
  const MonotonicTime too_old = last_beat_ + settings_.patience + Duration(1);
  const MonotonicTime ahead = too_old - settings_.looks_ahead;
  return now < ahead ? ahead : too_old;
}

bool Watch::must_write(MonotonicTime now) const noexcept {
  return !taken_since_ || now - *taken_since_ <= settings_.zero_for;
}

}  // namespace thimble::guard
