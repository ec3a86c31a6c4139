#include "guard/watch.hpp"

namespace thimble::guard {

bool Watch::look(MonotonicTime now, std::uint64_t beats, std::uint32_t acknowledged) noexcept {
  const bool has_beaten = beats != beats_;
  beats_ = beats;
  if (has_beaten) {
    is_armed_ = true;
    last_beat_ = now;
  }
  if (!is_armed_) return false;
  if (is_letting_go_ && has_beaten) {
    is_letting_go_ = acknowledged != interventions_;
    zero_since_ = now;
  }
  if (!is_letting_go_ && now - last_beat_ > settings_.patience) {
    is_letting_go_ = true;
    ++interventions_;
    zero_since_ = now;
  }
  return is_letting_go_ && now - zero_since_ <= settings_.zero_for;
}

}  // namespace thimble::guard
