#include "guard/guard_session.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "hal/linux/timespec.hpp"

namespace thimble::guard {
namespace {

// Ours: what a look would be if nothing told of the connection's end.
constexpr Duration kLookWithoutPoll = std::chrono::milliseconds(2);

}  // namespace

Result<GuardSession> GuardSession::accept(int socket, int timeout_ms, linux::DeviceCalls& calls) {
  auto received = receive_handover(socket, timeout_ms);
  if (!received) return tl::unexpected(received.error());
  auto page = SharedPage::map(std::move(received->page));
  if (!page) return tl::unexpected(page.error());
  GuardSession session(socket, std::move(*received), std::move(*page), calls);
  if (::send(socket, &kWatching, 1, MSG_NOSIGNAL | MSG_DONTWAIT) != 1) {
    return fail(Errc::Disconnected, std::string("the daemon is gone: ") + std::strerror(errno));
  }
  return session;
}

GuardSession::GuardSession(int socket, Received received, SharedPage page,
                           linux::DeviceCalls& calls) noexcept
    : socket_(socket),
      page_(std::move(page)),
      writer_(received.handover, std::move(received.node), calls) {}

// Nothing is ever said after the handover: whatever can be read is the end, or no daemon of ours.
bool GuardSession::has_ended() noexcept {
  char byte = 0;
  const ssize_t got = ::recv(socket_, &byte, 1, MSG_DONTWAIT);
  return got >= 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

bool GuardSession::step(const Clock& clock) noexcept {
  const MonotonicTime now = clock.now();
  is_ended_ = is_ended_ || has_ended();
  rt::Heartbeat& heart = page_.heartbeat();
  const MonotonicTime beat_at{Duration(heart.beat_at_ns.load(std::memory_order_acquire))};
  const std::uint32_t drive = heart.drive.load(std::memory_order_acquire);
  const std::uint32_t before = watch_.interventions();
  const bool must_write =
      is_ended_ ? watch_.look_alone(now, drive != 0) : watch_.look(now, beat_at, drive);
  // Told before it is done: a servo that wakes in between must not drive on. Guards before this one
  // have counted there, too.
  heart.interventions.fetch_add(watch_.interventions() - before, std::memory_order_release);
  if (must_write) {
    // What held it up for seconds may have held up a force, too, that leaves beside it: the while
    // in which zero is written begins when the kernel returns.
    const bool is_taken = writer_.write();
    watch_.wrote(clock.now(), is_taken);
    if (is_ended_ && !is_taken && writer_.is_gone()) return false;
  }
  return !is_ended_ || must_write;
}

void GuardSession::await_next(Clock& clock) noexcept {
  const MonotonicTime now = clock.now();
  const MonotonicTime next = watch_.next_look(now);
  if (is_ended_) {
    clock.sleep_until(next);
    return;
  }
  const timespec most = linux::to_timespec(std::max(next - now, Duration(0)));
  pollfd connection{socket_, POLLIN, 0};
  // Whatever it returns for, the next look finds out. Not if it is refused: that would be a loop
  // without end above every servo.
  const bool is_refused = ::ppoll(&connection, 1, &most, nullptr) < 0 && errno != EINTR;
  if (is_refused) clock.sleep_until(std::min(next, now + kLookWithoutPoll));
}

}  // namespace thimble::guard
