#include "hal/linux/event_fd.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <cstdint>
#include <limits>
#include <thread>

namespace thimble::linux {
namespace {

bool is_readable(const EventFd& event, int timeout_ms) {
  pollfd poll_fd{event.fd(), POLLIN, 0};
  return ::poll(&poll_fd, 1, timeout_ms) == 1;
}

TEST(EventFd, IsReadableFromASignalToTheDrain) {
  const auto sut = EventFd::create().value();
  EXPECT_FALSE(is_readable(*sut, 0));
  sut->signal();
  sut->signal();
  EXPECT_TRUE(is_readable(*sut, 0));
  EXPECT_EQ(sut->drain(), 2U);
  EXPECT_FALSE(is_readable(*sut, 0));
  EXPECT_EQ(sut->drain(), 0U) << "an empty drain does not wait";
}

TEST(EventFd, WakesAPollOnAnotherThread) {
  const auto sut = EventFd::create().value();
  bool was_woken = false;
  std::thread waiter([&] { was_woken = is_readable(*sut, -1); });
  sut->signal();
  waiter.join();
  EXPECT_TRUE(was_woken);
}

TEST(EventFd, ASignalNeverWaitsEvenWhenTheCounterIsFull) {
  const auto sut = EventFd::create().value();
  const std::uint64_t full = std::numeric_limits<std::uint64_t>::max() - 1;
  ASSERT_EQ(::write(sut->fd(), &full, sizeof(full)), static_cast<ssize_t>(sizeof(full)));
  sut->signal();
  EXPECT_EQ(sut->drain(), full);
}

TEST(EventFd, IsNotInheritedByOtherPrograms) {
  const auto sut = EventFd::create().value();
  EXPECT_NE(::fcntl(sut->fd(), F_GETFD) & FD_CLOEXEC, 0);
  EXPECT_NE(::fcntl(sut->fd(), F_GETFL) & O_NONBLOCK, 0);
}

}  // namespace
}  // namespace thimble::linux
