#include "lab/run/virtual_session.hpp"

#include <algorithm>

#include "daemon/link/earliest.hpp"

namespace thimble::lab {
namespace {

constexpr Duration kFollowEvery = std::chrono::milliseconds(5);
// Ours: what is due at once and again is not let hold the time.
constexpr Duration kLeastWait = std::chrono::microseconds(1);

}  // namespace

Result<std::unique_ptr<VirtualSession>> VirtualSession::create(
    const std::vector<PlayedFile>& files,
    const std::vector<std::unique_ptr<session::Plugins>>& plugins) {
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<VirtualSession> made(new VirtualSession(files));
  for (std::size_t i = 0; i < files.size(); ++i) {
    session::RigParts parts{plugins[i]->models, plugins[i]->drivers};
    parts.world_clock = parts.network_clock = &made->clock_;
    parts.network = &made->network_.host(i);
    parts.lines = &made->lines_.host(i);
    auto runtime = session::Runtime::create(files[i].config, parts);
    if (!runtime) {
      return tl::unexpected(files.size() > 1 ? runtime.error().in(files[i].name) : runtime.error());
    }
    for (std::size_t arm = 0; arm < (*runtime)->arms().size(); ++arm) {
      made->places_.push_back({i, arm});
    }
    made->runtimes_.push_back(*std::move(runtime));
  }
  made->period_ = made->arm(0).session().loop().settings().period();
  made->began_ = made->next_ = made->followed_at_ = made->arm(0).clock().now();
  return made;
}

void VirtualSession::sleep_until(MonotonicTime t) {
  for (std::size_t i = 0; i < arms(); ++i) (void)arm(i).clock().sleep_until(t);
}

void VirtualSession::pump(MonotonicTime now) {
  (void)clock_.sleep_until(now);
  std::optional<MonotonicTime> due;
  for (const auto& runtime : runtimes_) link::take_earlier(due, runtime->pump(now));
  network_.pass(now);
  lines_.pass();
  link::take_earlier(due, network_.due());
  link::take_earlier(due, lines_.due());
  net_due_ = due ? std::optional(std::max(*due, now + kLeastWait)) : std::nullopt;
}

void VirtualSession::tick() {
  next_ = next_ + period_;
  while (net_due_ && *net_due_ < next_) {
    const MonotonicTime due = *net_due_;
    sleep_until(due);
    pump(due);
  }
  sleep_until(next_);
  for (std::size_t i = 0; i < arms(); ++i) arm(i).session().loop().tick({});
  pump(next_);
  if (next_ - followed_at_ >= kFollowEvery) follow_buses();
}

void VirtualSession::follow_buses() {
  followed_at_ = next_;
  for (const auto& runtime : runtimes_) {
    for (const Error& trouble : runtime->follow_buses(next_)) {
      const bool is_told =
          std::find(troubles_.begin(), troubles_.end(), trouble.message) != troubles_.end();
      if (!is_told) troubles_.push_back(trouble.message);
    }
  }
}

}  // namespace thimble::lab
