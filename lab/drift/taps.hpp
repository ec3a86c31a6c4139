#pragma once

#include <cstdint>
#include <vector>

#include "hal/base/result.hpp"
#include "lab/trial/coupling_case.hpp"

// Taps on a wall of the thesis's box, one after the other.
namespace thimble::lab {

inline constexpr double kTapHand_m_per_s = 0.2;  // thesis 4.2.1
inline constexpr double kTapFrom_m = 0.005;      // before the wall; ours

struct TapRun {
  CouplingCase of;
  double delay_s{0};
  double taps_per_s{1};
  std::uint64_t taps{40};
};

struct Taps {
  std::vector<double> offsets_m;  // of the frame, when each tap was felt; a tap is one, felt or not
  double taps_per_s{0};           // that were done: fewer than wanted where each takes too long
  double generated_joule{0};      // given to the hand, of all taps together: the last sum
};

// A hand that nothing stops: from 5 mm before the wall, as it feels it, at 0.2 m/s until the wall
// pushes with 0.5 N, and back; in between it goes along with the frame. A tap that is not felt
// within 0.2 m, or a frame that is displaced by as much, ends the run. Deterministic. Errors: the
// scheme refuses the world.
[[nodiscard]] Result<Taps> run_taps(const TapRun& of);

// Of walls that are learned of late by offset (thesis 3.7; teleop.md 2(e), "Drift"). Each tap
// displaces the frame by g = n·v·D − H, and it returns by r·(1/f − n·D) until the next, the time in
// which the hand is not behind the wall. n: 1 streamed, 1.5 in lock-step; f taps a second. Pure.
struct TapTheory {
  double gain_m{0};          // g, at least 0
  double drift_m_per_s{0};   // f·g − r·(1 − f·n·D), at least 0
  double critical_per_s{0};  // f at which it begins: r/(g + r·n·D)
};
[[nodiscard]] TapTheory tap_theory(double delay_s, double taps_per_s, link::SendMode mode) noexcept;

// How fast the frame gets away: of the offsets after the first quarter, by least squares over the
// time of their taps. 0 where there are fewer than two.
[[nodiscard]] double drift_m_per_s(const Taps& taps) noexcept;

}  // namespace thimble::lab
