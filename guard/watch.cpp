#include "guard/watch.hpp"

namespace thimble::guard {

bool Watch::look(MonotonicTime now, std::uint64_t beats, bool is_driven) noexcept {
  const bool has_beaten = beats != beats_ || !is_driven_;
  beats_ = beats;
  is_driven_ = is_driven;
  if (has_beaten) {
    last_beat_ = now;
    taken_since_.reset();
  }
  if (!is_driven) {
    is_letting_go_ = false;
    return false;
  }
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

bool Watch::must_write(MonotonicTime now) const noexcept {
  return !taken_since_ || now - *taken_since_ <= settings_.zero_for;
}

}  // namespace thimble::guard
