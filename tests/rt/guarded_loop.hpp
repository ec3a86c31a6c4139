#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>

#include "daemon/link/udp_network.hpp"
#include "daemon/session/plugins.hpp"
#include "daemon/session/runtime.hpp"
#include "hal/linux/event_fd.hpp"
#include "tests/rt/thread_calls.hpp"

namespace thimble::test {

// The machine's clock for a test that has no time to lose: sleeping only moves it on.
class FreeWheelingClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override { return now_; }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    // Every hundredth sleep oversleeps, so that the brake has to wait.
    const Duration lateness = ++sleeps_ % 100 == 0 ? std::chrono::milliseconds(1) : Duration{};
    if (deadline > now_) now_ = deadline + lateness;
    return lateness;
  }

 private:
  MonotonicTime now_{};
  std::uint64_t sleeps_{0};
};

enum class Pace { Virtual, RealTimeBrake };

// A session as the daemon makes it, one arm, ticked as its servo thread does; what that part
// asked of the C library is counted, what the net plane does between the ticks is not.
class GuardedLoop {
 public:
  GuardedLoop(const std::string& config, Pace pace);

  // The sum over `ticks` servo periods, each the sleep (which runs the simulated arm) and tick().
  ThreadCalls run(int ticks);

  [[nodiscard]] session::ArmRig& arm() { return *runtime_->arms().front(); }
  [[nodiscard]] session::WorldHost& world() { return *runtime_->worlds().front(); }
  [[nodiscard]] servo::ServoControls& controls() { return arm().session().controls(); }
  [[nodiscard]] const servo::ServoSnapshot& snapshot() { return arm().session().snapshot(); }
  [[nodiscard]] bool is_made() const noexcept { return runtime_ != nullptr; }

 private:
  void serve_net_plane();

  FreeWheelingClock real_clock_;
  std::unique_ptr<linux::EventFd> wake_;
  boost::asio::io_context io_;
  link::UdpNetwork network_{io_};
  session::Plugins plugins_;
  std::unique_ptr<session::Runtime> runtime_;
  MonotonicTime next_{};
};

}  // namespace thimble::test
