#include "lab/run/virtual_session.hpp"

#include <algorithm>

namespace thimble::lab {
namespace {

constexpr Duration kFollowEvery = std::chrono::milliseconds(5);

}  // namespace

Result<std::unique_ptr<VirtualSession>> VirtualSession::create(const config::Config& config,
                                                               const session::Plugins& plugins) {
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<VirtualSession> made(new VirtualSession);
  session::RigParts parts{plugins.models, plugins.drivers};
  parts.world_clock = &made->world_clock_;
  auto runtime = session::Runtime::create(config, parts);
  if (!runtime) return tl::unexpected(runtime.error());
  made->runtime_ = *std::move(runtime);
  made->period_ = made->arm(0).session().loop().settings().period();
  made->began_ = made->next_ = made->followed_at_ = made->arm(0).clock().now();
  return made;
}

void VirtualSession::sleep_until(MonotonicTime t) {
  for (const auto& rig : runtime_->arms()) (void)rig->clock().sleep_until(t);
}

void VirtualSession::pump(MonotonicTime now) {
  (void)world_clock_.sleep_until(now);
  net_due_ = runtime_->pump(now);
}

void VirtualSession::tick() {
  next_ = next_ + period_;
  while (net_due_ && *net_due_ < next_) {
    const MonotonicTime due = *net_due_;
    sleep_until(due);
    pump(due);
  }
  sleep_until(next_);
  for (const auto& rig : runtime_->arms()) rig->session().loop().tick({});
  pump(next_);
  if (next_ - followed_at_ >= kFollowEvery) follow_buses();
}

void VirtualSession::follow_buses() {
  followed_at_ = next_;
  for (const Error& trouble : runtime_->follow_buses(next_)) {
    const bool is_told =
        std::find(troubles_.begin(), troubles_.end(), trouble.message) != troubles_.end();
    if (!is_told) troubles_.push_back(trouble.message);
  }
}

}  // namespace thimble::lab
