#pragma once

#include <cstdint>
#include <string_view>

namespace thimble::linux {

// Writes lines to a descriptor and never waits for who reads them: a terminal that is stopped, or a
// pipe that nobody empties, must not hold up a thread that has an arm to look after. A line for
// which there is no room at once is lost; the next one that goes out is told to come after a gap.
//
// Thread: one at a time. Not RT. Ownership: the descriptor stays the caller's, and stays as it is
// (the mode O_NONBLOCK would belong to every program that shares it). Errors: none; lost() counts.
class LineOutput {
 public:
  explicit LineOutput(int descriptor) noexcept : descriptor_(descriptor) {}

  // `line` ends in a line break; one of more than kMostBytes is cut.
  void write(std::string_view line) noexcept;
  // Lines that did not go out, in all.
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

  // What a pipe that poll(2) calls writable takes without waiting: PIPE_BUF of Linux.
  static constexpr std::size_t kMostBytes = 4096;

 private:
  bool put(std::string_view text) noexcept;

  int descriptor_;
  bool is_torn_{false};  // the last line went out in part
  std::uint64_t lost_{0};
  std::uint64_t lost_since_{0};  // the last line that went out
};

}  // namespace thimble::linux
