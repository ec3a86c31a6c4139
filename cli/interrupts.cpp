#include "cli/interrupts.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>

namespace thimble::cli {
namespace {

sigset_t our_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, signal);
  return set;
}

int milliseconds(double time_s) {
  if (time_s < 0) return -1;
  return static_cast<int>(std::min(time_s * 1000 + 0.5, 1e9));
}

}  // namespace

Interrupts::Interrupts() {
  const sigset_t set = our_signals();
  sigprocmask(SIG_BLOCK, &set, nullptr);
  signals_ = ::signalfd(-1, &set, SFD_CLOEXEC);
}

// The signals stay blocked: one that came late must not end the process before it has put the
// terminal back.
Interrupts::~Interrupts() { ::close(signals_); }

Interrupts::Woken Interrupts::wait(int descriptor, double timeout_s) {
  std::array<pollfd, 2> polled{{{signals_, POLLIN, 0}, {descriptor, POLLIN, 0}}};
  ::poll(polled.data(), polled.size(), milliseconds(timeout_s));
  if (polled[0].revents != 0) return Woken::Signal;
  if (polled[1].revents != 0) return Woken::Readable;
  return Woken::Timeout;
}

}  // namespace thimble::cli
