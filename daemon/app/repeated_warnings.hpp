#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "hal/base/time.hpp"

namespace thimble::app {

// Lets a warning through when it is new; while it comes again and again, once a minute with the
// number of those that were held back meanwhile.
//
// Thread: one. Not RT. Memory is bounded: of too many different ones the stalest is forgotten.
class RepeatedWarnings {
 public:
  // Ours: seldom enough not to fill a journal, often enough to show that it goes on.
  static constexpr Duration kAgain = std::chrono::minutes(1);
  // Not heard for so long, it is news again. Ours: a few of the longest retries (2 s).
  static constexpr Duration kForgotten = std::chrono::seconds(10);
  static constexpr std::size_t kMost = 64;

  // What to write to the log, if anything.
  [[nodiscard]] std::optional<std::string> admit(const std::string& warning, MonotonicTime now);

 private:
  struct Seen {
    MonotonicTime said_at{};
    MonotonicTime heard_at{};
    std::uint64_t held_back{0};
  };
  void make_room();

  std::map<std::string, Seen> seen_;
};

}  // namespace thimble::app
