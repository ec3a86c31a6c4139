#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

// How schemes are ranked beside each other: what is asked of each, and what it weighs. Fixed before
// our own scheme, `composite`, was written (docs/decisions/0441).
namespace thimble::lab {

// SOURCE of all ten and of what each is divided by: teleop.md section 5; 0 is ideal, lower is
// better.
enum class Metric : std::uint8_t {
  Onset,         // M1: from the true contact until 0.5 N are felt, in 100 ms
  Stiffness,     // M2: error of the stiffness felt in the first 5 mm, of the wall's
  Displacement,  // M3: of the place where the contact is felt, in 50 mm
  Drag,          // M4: in free space, in 1 N at 0.2 m/s, and in 1 kg of mass felt
  Hold,          // M5: error of the force of a hand that pushes, and of one that holds a place
  Residue,       // M6: force after the hand has left, in 1 N
  Edge,          // M7: how far past an edge the wall is felt, in 10 mm
  MissedTaps,    // M8: share of taps of 30, 60, 120, 250 ms that are not felt
  Recovery,      // M9: after an outage of 200 ms, force astray in 1 N, and for how long in 1 s
  Traffic,       // M10: packets a second, in 2,000
};
inline constexpr std::size_t kMetrics = 10;
[[nodiscard]] std::string_view to_string(Metric metric) noexcept;

// SOURCE: teleop.md section 5, "Gates". A scheme that fails one ranks behind all that do not.
enum class Gate : std::uint8_t {
  Bounded,       // G1: a hand that holds still is still, peak to peak, within 0.5 mm
  Passive,       // G2: energy given to the hand within the declared bound
  Smooth,        // G3: no force beyond 8.5 N, and none that rises by more than 2 N in a tick
  NotAttractive  // G4: no wall pulls
};
inline constexpr std::size_t kGates = 4;
[[nodiscard]] std::string_view to_string(Gate gate) noexcept;

struct Marks {
  std::array<double, kMetrics> metrics{};  // of each, at least 0 and at most kWorst
  std::array<bool, kGates> fails{};
};
// Ours: so that one metric does not decide alone; what is not felt at all gets it.
inline constexpr double kWorst = 3;
// `value` as a mark: what is not a number is the worst.
[[nodiscard]] double bounded_mark(double value) noexcept;

using Weights = std::array<double, kMetrics>;
// SOURCE: teleop.md section 5, "Suggested weights".
inline constexpr Weights kWeights{2, 3, 2, 2, 2, 1, 1, 1, 1, 1};
inline constexpr Weights kEqualWeights{1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
// kWeights without one.
[[nodiscard]] Weights without(Metric metric) noexcept;

// Weighted mean of the marks.
[[nodiscard]] double score_of(const Marks& marks, const Weights& weights) noexcept;

// Of one scheme, its marks on each network.
using NetworkMarks = std::vector<Marks>;
struct Standing {
  std::size_t scheme{0};  // index
  std::size_t failed{0};  // networks on which it fails a gate
  double score{0};        // mean over the networks
};
// The best first: by failed networks, then by score, then by index. Each scheme was on the same
// networks, at least one.
[[nodiscard]] std::vector<Standing> rank(std::span<const NetworkMarks> schemes,
                                         const Weights& weights);
// The place of a scheme among them, from 1; those that fail as many gates share it where their
// scores differ by less than kSameScore.
inline constexpr double kSameScore = 1e-3;  // ours: less than the tables show
[[nodiscard]] std::size_t place_of(std::size_t scheme, std::span<const Standing> standings);

}  // namespace thimble::lab
