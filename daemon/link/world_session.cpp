#include "daemon/link/world_session.hpp"

#include <algorithm>

namespace thimble::link {

bool WorldSession::open(const coupling::HandSample& first, MonotonicTime now,
                        LinkCounters& counters) {
  const Result<void> opened = world_->open(first);
  if (!opened) {
    last_error_ = opened.error().message;
    counters.reject(RejectReason::SessionRefused);
    return false;
  }
  is_open_ = true;
  heard_at_ = now;
  ++counters.sessions_opened;
  return true;
}

coupling::ConstraintSet WorldSession::answer(const coupling::HandSample& sample,
                                             MonotonicTime now) noexcept {
  const Duration step = std::clamp(now - heard_at_, kMinStep, kMaxStep);
  heard_at_ = now;
  return world_->answer(sample, step);
}

bool WorldSession::release_if_silent(MonotonicTime now, LinkCounters& counters) noexcept {
  if (!is_open_ || now < silent_at()) return false;
  close();
  ++counters.sessions_released;
  return true;
}

void WorldSession::close() noexcept {
  if (!is_open_) return;
  is_open_ = false;
  world_->close();
}

}  // namespace thimble::link
