#include "tests/rt/guarded_loop.hpp"

#include <gtest/gtest.h>

#include "daemon/config/load.hpp"

namespace thimble::test {

GuardedLoop::GuardedLoop(const std::string& config, Pace pace) {
  const config::ConfigResult parsed = config::parse(config, "guarded-loop.toml", {});
  if (!parsed) {
    ADD_FAILURE() << to_string(parsed.error().front());
    return;
  }
  Result<std::unique_ptr<linux::EventFd>> wake = linux::EventFd::create();
  if (!wake) {
    ADD_FAILURE() << wake.error().message;
    return;
  }
  wake_ = *std::move(wake);
  for (const Error& refused : plugins_.load(parsed->daemon.plugins)) {
    ADD_FAILURE() << refused.message;
  }
  session::RigParts parts{plugins_.models, plugins_.drivers};
  parts.wake = wake_.get();
  parts.network = &network_;
  if (pace == Pace::RealTimeBrake) parts.real_clock = &real_clock_;
  Result<std::unique_ptr<session::Runtime>> runtime = session::Runtime::create(*parsed, parts);
  if (!runtime) {
    ADD_FAILURE() << runtime.error().message;
    return;
  }
  runtime_ = *std::move(runtime);
  next_ = arm().clock().now();
}

ThreadCalls GuardedLoop::run(int ticks) {
  servo::ServoLoop& loop = arm().session().loop();
  Clock& clock = arm().clock();
  const Duration period = loop.settings().period();
  ThreadCalls sum;
  for (int i = 0; i < ticks; ++i) {
    next_ = next_ + period;
    const ThreadCalls before = thread_calls();
    const Duration lateness = clock.sleep_until(next_);
    loop.tick(lateness);
    const ThreadCalls calls = thread_calls() - before;
    sum.allocations += calls.allocations;
    sum.frees += calls.frees;
    sum.locks += calls.locks;
    serve_net_plane();
  }
  return sum;
}

void GuardedLoop::serve_net_plane() {
  (void)wake_->drain();
  (void)runtime_->pump(arm().clock().now());
  (void)io_.poll();
  EXPECT_TRUE(runtime_->follow_buses(arm().clock().now()).empty());
}

}  // namespace thimble::test
