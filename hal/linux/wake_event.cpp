#include "hal/linux/wake_event.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

#include "hal/linux/timespec.hpp"

namespace thimble::linux {

Result<std::unique_ptr<WakeEvent>> WakeEvent::create() {
  Descriptor event(::eventfd(0, EFD_CLOEXEC));
  if (event.get() < 0) return fail(Errc::System, std::string("eventfd: ") + std::strerror(errno));
  // The constructor is private, so make_unique cannot reach it.
  return std::unique_ptr<WakeEvent>(new WakeEvent(std::move(event)));
}

void WakeEvent::signal() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(event_.get(), &one, sizeof(one));
}

void WakeEvent::wait() noexcept {
  std::uint64_t signals = 0;
  while (::read(event_.get(), &signals, sizeof(signals)) < 0 && errno == EINTR) {
  }
}

bool WakeEvent::wait_at_most(Duration most) noexcept {
  const timespec patience = to_timespec(std::max(most, Duration(0)));
  pollfd watched{event_.get(), POLLIN, 0};
  if (::ppoll(&watched, 1, &patience, nullptr) <= 0) return false;
  wait();
  return true;
}

}  // namespace thimble::linux
