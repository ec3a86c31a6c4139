#include "hal/linux/event_fd.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

namespace thimble::linux {

Result<std::unique_ptr<EventFd>> EventFd::create() {
  const int fd = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (fd < 0) return fail(Errc::System, std::string("eventfd: ") + std::strerror(errno));
  return std::unique_ptr<EventFd>(new EventFd(fd));
}

EventFd::~EventFd() { ::close(fd_); }

void EventFd::signal() noexcept {
  const std::uint64_t one = 1;
  // Refused only when 2^64-2 signals wait: then it is readable anyway.
  [[maybe_unused]] const ssize_t written = ::write(fd_, &one, sizeof(one));
}

std::uint64_t EventFd::drain() noexcept {
  std::uint64_t count = 0;
  if (::read(fd_, &count, sizeof(count)) != static_cast<ssize_t>(sizeof(count))) return 0;
  return count;
}

}  // namespace thimble::linux
