#pragma once

#include <cstdint>

namespace thimble::test {

// What the calling thread has asked of the C library since it started. Linking this replaces
// malloc and its family and the locks of pthread by counters in front of the real ones, so that
// operator new, std::string and std::mutex are all seen, in our code and in libraries.
struct ThreadCalls {
  std::uint64_t allocations{0};
  std::uint64_t frees{0};
  std::uint64_t locks{0};

  bool operator==(const ThreadCalls&) const = default;
  friend ThreadCalls operator-(const ThreadCalls& a, const ThreadCalls& b) noexcept {
    return {a.allocations - b.allocations, a.frees - b.frees, a.locks - b.locks};
  }
};

// False under a sanitizer: it has replaced the same functions and allocates in its own.
[[nodiscard]] bool can_count_thread_calls() noexcept;
[[nodiscard]] ThreadCalls thread_calls() noexcept;

}  // namespace thimble::test
