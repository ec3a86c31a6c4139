#pragma once

#include <array>
#include <cstdint>

#include "drivers/phantom/phantom_model.hpp"
#include "hal/base/time.hpp"
#include "hal/base/units.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::phantom {

// Follows the controller's three 16-bit base counters through their wraps, and tells when
// what it sees cannot have been motion.
//
// The shortest way round is the true one as long as no motor can have turned further than half
// the counter's range. Between two stops none of the table's arms can (a test holds the table to
// it), so a gap of any length leaves no doubt; for an arm that could, the gap bounds it.
//
// Thread: one. RT: all THIMBLE_RT. A value. Errors: none; what cannot have been motion is told.
class CounterTracker {
 public:
  using Raw = std::array<std::int16_t, 3>;

  explicit CounterTracker(const PhantomModel& model) noexcept;

  // Takes `raw` as the distance from the home pose.
  THIMBLE_RT void restart(const Raw& raw) noexcept;
  // Adds the way since the last call. False, and nothing changes, when the controller must
  // have been reset, the bytes or the reference are wrong, or the way cannot be told: a step
  // larger than largest_step(), a joint beyond its stops and kMargin_rad, all three counters at
  // exactly zero after a step of more than kResetStep_counts, or `elapsed` too long to be
  // unwrapped.
  THIMBLE_RT [[nodiscard]] bool follow(const Raw& raw, Duration elapsed) noexcept;

  // Bound of a step of one motor in `elapsed`: the model's motor speed limit for that time and
  // kSlack, and never more than the way between its stops.
  THIMBLE_RT [[nodiscard]] std::int32_t largest_step(std::size_t motor,
                                                     Duration elapsed) const noexcept;
  [[nodiscard]] const std::array<EncoderCounts, 3>& counts() const noexcept { return counts_; }

  // Reports are stamped on arrival: what the bus's own jitter may add to the time between.
  static constexpr Duration kSlack = std::chrono::milliseconds(1);
  static constexpr std::int32_t kHalfRange_counts = 32767;
  // Four frames at the daemon's overspeed limit of 1.5 m/s. Ours.
  static constexpr std::int32_t kResetStep_counts = 200;
  // For a home pose held askew, and stops that give way. Ours: 17 degrees.
  static constexpr double kMargin_rad = 0.3;

 private:
  struct Range {
    std::int32_t min{0};
    std::int32_t max{0};
  };
  std::array<double, 3> limit_counts_per_s_{};
  std::array<Range, 3> range_{};  // in counts from the home pose, the margin included
  Raw last_{};
  std::array<EncoderCounts, 3> counts_{};
};

}  // namespace thimble::phantom
