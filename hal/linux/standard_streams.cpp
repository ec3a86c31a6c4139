#include "hal/linux/standard_streams.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

namespace thimble::linux {
namespace {

// poll(2): of a pipe's or a socket's writing end, the reader is gone.
bool is_reader_gone() {
  pollfd polled{STDOUT_FILENO, POLLOUT, 0};
  return ::poll(&polled, 1, 0) == 1 && (polled.revents & POLLERR) != 0;
}

}  // namespace

void occupy_closed_standard_descriptors() noexcept {
  // Each open gets the lowest free number, so the order matters.
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(number, F_GETFD) >= 0) continue;
    const int mode = number == STDOUT_FILENO ? O_RDONLY : O_RDWR;
    static_cast<void>(::open("/dev/null", mode | O_NOCTTY));
  }
}

Result<void> flush_standard_output() {
  const bool had_failed = std::ferror(stdout) != 0;
  const int error = std::fflush(stdout) == 0 ? 0 : errno;
  if (!had_failed && error == 0) return {};
  const std::string reason = error == 0 ? "" : std::string(": ") + std::strerror(error);
  return fail(is_reader_gone() ? Errc::Disconnected : Errc::System,
              "cannot write to standard output" + reason);
}

}  // namespace thimble::linux
