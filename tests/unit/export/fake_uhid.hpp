#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/uhid.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <initializer_list>
#include <optional>

#include "hal/linux/descriptor.hpp"

namespace thimble::sim {

// The kernel at the other end of /dev/uhid, as a socket pair that keeps messages apart.
class FakeUhid {
 public:
  FakeUhid() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()),
              0);
    device_ = linux::Descriptor(ends[0]);
    kernel_ = linux::Descriptor(ends[1]);
  }
  // What the plug is given; once.
  linux::Descriptor take_device_end() { return std::move(device_); }
  void close() { kernel_ = linux::Descriptor(); }

  void say(const uhid_event& event) {
    ASSERT_EQ(::write(kernel_.get(), &event, sizeof event), static_cast<ssize_t>(sizeof event));
  }
  void say(std::uint32_t type) {
    uhid_event event{};
    event.type = type;
    say(event);
  }
  void say_bytes(const void* bytes, std::size_t size) {
    ASSERT_EQ(::write(kernel_.get(), bytes, size), static_cast<ssize_t>(size));
  }
  // As hidraw writes: with a byte for the number in front.
  void write_output(std::initializer_list<std::uint8_t> bytes) {
    uhid_event event{};
    event.type = UHID_OUTPUT;
    event.u.output.rtype = UHID_OUTPUT_REPORT;
    event.u.output.size = static_cast<std::uint16_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), event.u.output.data);
    say(event);
  }
  // The next thing that the device said.
  std::optional<uhid_event> heard() {
    uhid_event event{};
    const ssize_t got = ::read(kernel_.get(), &event, sizeof event);
    if (got <= 0) return std::nullopt;
    return event;
  }
  // The last input report that came, if any; everything else that came is dropped.
  std::optional<uhid_input2_req> last_input() {
    std::optional<uhid_input2_req> last;
    while (const auto event = heard()) {
      if (event->type == UHID_INPUT2) last = event->u.input2;
    }
    return last;
  }

 private:
  linux::Descriptor device_;
  linux::Descriptor kernel_;
};

}  // namespace thimble::sim
