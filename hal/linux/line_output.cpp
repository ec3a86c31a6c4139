#include "hal/linux/line_output.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>

namespace thimble::linux {
namespace {

bool has_room(int descriptor) noexcept {
  pollfd polled{descriptor, POLLOUT, 0};
  return ::poll(&polled, 1, 0) == 1 && (polled.revents & POLLOUT) != 0;
}

}  // namespace

void LineOutput::write(std::string_view line) noexcept {
  if (lost_since_ > 0) {
    std::array<char, 96> gap{};
    const int size =
        std::snprintf(gap.data(), gap.size(), "(%llu lines that nobody read are lost)\n",
                      static_cast<unsigned long long>(lost_since_));
    if (size > 0 && put({gap.data(), static_cast<std::size_t>(size)})) lost_since_ = 0;
  }
  const bool is_out = lost_since_ == 0 && put(line.substr(0, kMostBytes));
  if (is_out && line.size() > kMostBytes) is_torn_ = true;
  if (is_out) return;
  ++lost_;
  ++lost_since_;
}

bool LineOutput::put(std::string_view text) noexcept {
  if (is_torn_) {
    is_torn_ = false;
    if (!put("\n")) {
      is_torn_ = true;
      return false;
    }
  }
  if (!has_room(descriptor_)) return false;
  const ssize_t count = ::write(descriptor_, text.data(), text.size());
  if (count == static_cast<ssize_t>(text.size())) return true;
  is_torn_ = count > 0;
  return false;
}

}  // namespace thimble::linux
