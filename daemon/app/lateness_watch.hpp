#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "hal/base/time.hpp"

namespace thimble::app {

// Whether `missed` periods of a servo are told to a person. Ours: from a millisecond on, which is a
// period of the default rate and a frame of a full-speed bus: what a faster servo misses for less
// no arm has noticed. Pure.
[[nodiscard]] bool is_worth_telling(std::uint64_t missed, Duration period) noexcept;

// How many servo periods each arm missed in the last ten seconds: what "degraded" means for a
// person who looks now. The totals since the start are in the servo's own counters.
//
// Thread: one. Not RT.
class LatenessWatch {
 public:
  // Ours: long enough to be read, short enough to go away when the load does.
  static constexpr Duration kWindow = std::chrono::seconds(10);

  // `overruns`: the arm's count since its servo started; smaller than before: another one has taken
  // over.
  void note(std::size_t arm, MonotonicTime now, std::uint64_t overruns);
  [[nodiscard]] std::uint64_t missed_lately(std::size_t arm) const;

 private:
  struct Mark {
    MonotonicTime at{};
    std::uint64_t overruns{0};
  };
  struct Arm {
    std::deque<Mark> changes;  // when the count rose, and from what
    std::uint64_t overruns{0};
  };
  std::vector<Arm> arms_;
};

}  // namespace thimble::app
