#include "daemon/app/repeated_warnings.hpp"

#include <algorithm>
#include <utility>

namespace thimble::app {

std::optional<std::string> RepeatedWarnings::admit(const std::string& warning, MonotonicTime now) {
  const auto found = seen_.find(warning);
  if (found == seen_.end() || now - found->second.heard_at >= kForgotten) {
    if (found == seen_.end()) make_room();
    seen_[warning] = {now, now, 0};
    return warning;
  }
  Seen& seen = found->second;
  seen.heard_at = now;
  if (now - seen.said_at < kAgain) {
    ++seen.held_back;
    return std::nullopt;
  }
  seen.said_at = now;
  const std::uint64_t held_back = std::exchange(seen.held_back, 0);
  return warning + " (and " + std::to_string(held_back) + " times more)";
}

void RepeatedWarnings::make_room() {
  if (seen_.size() < kMost) return;
  seen_.erase(std::min_element(seen_.begin(), seen_.end(), [](const auto& a, const auto& b) {
    return a.second.heard_at < b.second.heard_at;
  }));
}

}  // namespace thimble::app
