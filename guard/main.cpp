#include <csignal>
#include <cstdio>
#include <string>
#include <string_view>

#include "guard/guard_session.hpp"
#include "hal/base/realtime_priority.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "hal/linux/realtime_process.hpp"
#include "hal/linux/realtime_thread.hpp"

namespace {

using namespace thimble;

// The connection that the daemon or systemd (StandardInput=socket) made.
constexpr int kConnection = 0;

// The end of the connection is its only end: who ends the daemon ends it, too, as a rule at the
// same moment, and the arm's zeros go on for 100 ms then. systemd waits for 30 s (TimeoutStopSec=).
void outlive_requests_to_end() noexcept {
  sigset_t requests;
  sigemptyset(&requests);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&requests, signal);
  ::pthread_sigmask(SIG_BLOCK, &requests, nullptr);
}

void watch(guard::GuardSession& session) noexcept {
  linux::MonotonicClock clock;
  while (session.step(clock)) session.await_next(clock);
}

int run() {
  outlive_requests_to_end();
  const linux::RealtimeProcess process;
  linux::KernelCalls calls;
  auto session = guard::GuardSession::accept(kConnection, guard::kHandoverTimeout_ms, calls);
  if (!session) {
    std::fprintf(stderr, "thimble-guard: %s\n", session.error().message.c_str());
    return 1;
  }
  {
    auto thread = linux::RealtimeThread::start({.name = "guard", .priority = kGuardPriority},
                                               process.report(), [&] { watch(*session); });
    if (!thread) {
      std::fprintf(stderr, "thimble-guard: %s\n", thread.error().message.c_str());
      return 1;
    }
  }
  if (session->interventions() > 0) {
    const guard::ZeroWriter& zeros = session->zeros();
    std::fprintf(stderr,
                 "thimble-guard: the servo stopped %u times, and the arm was let go: zero was "
                 "written %s times and refused %s times\n",
                 session->interventions(), std::to_string(zeros.written()).c_str(),
                 std::to_string(zeros.refused()).c_str());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) {
    const bool is_version = std::string_view(argv[1]) == "--version";
    if (is_version) std::puts("thimble-guard " THIMBLE_VERSION);
    if (!is_version) {
      std::fputs(
          "usage: thimble-guard\nthimbled starts it, or systemd does for thimbled; its "
          "standard input is their connection. See thimble-guard(8).\n",
          stderr);
    }
    return is_version ? 0 : 2;
  }
  return run();
}
