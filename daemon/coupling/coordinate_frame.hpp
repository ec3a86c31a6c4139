#pragma once

#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Euclidean norm whose sum is in order of size: permuted axes give the same bits.
[[nodiscard]] THIMBLE_RT double symmetric_length_m(Displacement3 v) noexcept;

// Where the world's frame lies beside the arm's: q = p + o (thesis 3.7), axes parallel, and |o|
// within a bound: no plane, however absurd, moves the frame further than an arm reaches (decision
// 0056).
//
// Thread: one servo thread. RT: all calls THIMBLE_RT. Units: m. Errors: none; a shift that is not
// finite moves nothing.
class CoordinateFrame {
 public:
  explicit CoordinateFrame(double max_offset_m) noexcept : max_offset_m_(max_offset_m) {}

  [[nodiscard]] Displacement3 offset() const noexcept { return offset_; }
  THIMBLE_RT void reset() noexcept { offset_ = {}; }
  // Moves as far along `by` as the bound lets it. The shift is cut, not the offset: walls across it
  // must not feel anything of it.
  THIMBLE_RT void shift(Displacement3 by) noexcept;

 private:
  double max_offset_m_;
  Displacement3 offset_{};
};

// Relaxation stops this far before a wall. Ours: a thousand times kNegligible_m, so that rounding
// does not touch it; the hardest wall (kHardestTool) would push with 3 mN there.
inline constexpr double kStandoff_m = 1e-6;
// A servo that stalled longer does not move the frame by the whole stall at once. Ours: the
// lateness that is a fault (DESIGN section 4, "servo late"); at 25 mm/s the 0.5 mm of the
// hysteresis.
inline constexpr double kLongestStep_s = 0.02;
// Shifts below are rounding, not events. Ours: of a plane as far as one may be (1000 km, decision
// 0056) a double rounds by 0.1 nm.
inline constexpr double kNegligible_m = 1e-9;

}  // namespace thimble::coupling
