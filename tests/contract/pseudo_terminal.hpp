#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/linux/descriptor.hpp"

namespace thimble::test {

// A terminal of the kernel's own, with the device at its master's end. Thread: one.
class PseudoTerminal {
 public:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr int kPatience_ms = 10'000;  // for what the kernel is bound to do

  PseudoTerminal() : device_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    EXPECT_EQ(::grantpt(device_.get()), 0);
    EXPECT_EQ(::unlockpt(device_.get()), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(::ptsname_r(device_.get(), name.data(), name.size()), 0);
    node_ = name.data();
    // Keeps the terminal as it was set while nobody has it open.
    host_ = linux::Descriptor(::open(node_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  }
  [[nodiscard]] const std::string& node() const { return node_; }
  void send(const Bytes& bytes) {
    EXPECT_EQ(::write(device_.get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  // Waits until `size` bytes have come in all.
  const Bytes& received(std::size_t size) {
    std::array<std::uint8_t, 4096> buffer{};
    while (received_.size() < size && device_.get() >= 0 && is_ready(device_.get())) {
      const ssize_t bytes = ::read(device_.get(), buffer.data(), buffer.size());
      if (bytes <= 0) break;
      received_.insert(received_.end(), buffer.begin(), buffer.begin() + bytes);
    }
    return received_;
  }
  // Whether the host finds anything to read.
  [[nodiscard]] bool has_arrived() const { return is_ready(host_.get()); }
  void set_deaf(bool is_deaf) { EXPECT_EQ(::tcflow(host_.get(), is_deaf ? TCOOFF : TCOON), 0); }
  void unplug() { device_ = linux::Descriptor(); }

 private:
  static bool is_ready(int node) {
    pollfd watched{node, POLLIN, 0};
    return ::poll(&watched, 1, kPatience_ms) == 1;
  }

  linux::Descriptor device_;
  linux::Descriptor host_;
  std::string node_;
  Bytes received_;
};

}  // namespace thimble::test
