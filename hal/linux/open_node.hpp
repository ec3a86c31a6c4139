#pragma once

#include <unistd.h>

#include <utility>

namespace thimble::linux {

// A descriptor that closes itself. Thread: one owner at a time. Errors: none; -1 is none.
class OpenNode {
 public:
  explicit OpenNode(int fd) noexcept : fd_(fd) {}
  OpenNode(OpenNode&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  OpenNode& operator=(OpenNode&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~OpenNode() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const noexcept { return fd_; }

 private:
  int fd_;
};

}  // namespace thimble::linux
