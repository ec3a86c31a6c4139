#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"
#include "lab/compare/bounded.hpp"
#include "lab/compare/ranking.hpp"
#include "lab/compare/stage.hpp"
#include "lab/findings/findings.hpp"

namespace thimble::lab {

// Of the hand that probes the wall (play_probe). NaN: not felt, or nothing to be measured.
struct Probed {
  double onset_s{0};                 // from the true contact until 0.5 N
  double stiffness_newton_per_m{0};  // felt, in the first 5 mm
  double displacement_m{0};          // of the place where 0.5 N are felt
};

// What one scheme made of one network, in the scenarios of teleop.md sections 3 and 5, each named
// as in scenarios.hpp. SI.
struct Measures {
  Probed probed{};              // from 60 mm before the wall: what is ranked
  Probed probed_near{};         // from 30 mm: ranked beside
  double drag_newton{0};        // approach: in free space at 0.2 m/s, mean
  double mass_kg{0};            // shake: felt in free space at 2 Hz
  double push_error_newton{0};  // push: RMS in the last second of 3, of a hand of 2 N
  double hold_newton{0};        // approach: mean in the last second of the hold
  double swing_m{0};            // approach: peak to peak in that second
  double residue_newton{0};     // approach: mean in the last 0.3 s, after the hand has left
  double edge_m{0};             // edge: past it, where the wall is last felt
  double missed_share{0};       // taps
  double astray_newton{0};      // outage: most that the force is off, from its begin on
  double astray_s{0};           // outage: how long after its end
  double packets_per_s{0};      // approach: both directions
  double bytes_per_s{0};        // approach: of them, as datagrams of ours in the clear
  double generated_joule{0};    // approach, push, edge, outage: given to the hand, where most of
                                // the declared was
  double declared_joule{0};     // what the scheme may there
  double most_newton{0};        // approach, push, edge, outage
  double most_rise_newton{0};   // the same and taps: in a tick
  double most_jump_newton{0};   // of that, without what a hand faster than 0.2 m/s adds: judged.cpp
  double most_pull_newton{0};   // the same and taps: towards the wall, in contact
  HeldAtWall held{};            // hold; no mark and no gate: decision 0465
};

// SOURCE: teleop.md section 5, G3: what the arm gives.
inline constexpr double kMost_newton = 8.5;

// Plays all scenarios. Deterministic. Errors: the scheme refuses the world.
[[nodiscard]] Result<Measures> measure(const CouplingCase& of, const StageSettings& settings);

// How marks are made. All but the first are ranked beside it, and decide nothing: decision 0478.
enum class Reading : std::uint8_t {
  Decided,        // decision 0441
  RiseOf1Newton,  // G3 by the fact sheet's letter: no rise by more than 1 N in a tick, as it is
                  // felt
  WithBytes,      // M10: mean of packets and of bytes, in those of the reference
  ProbedNear,     // M1 to M3 of the hand that probes from 30 mm
};
inline constexpr std::array kReadingsBeside{Reading::RiseOf1Newton, Reading::WithBytes,
                                            Reading::ProbedNear};
[[nodiscard]] std::string_view to_string(Reading reading) noexcept;

// `reference`: of the reference scheme at no delay, in the same world, whose front moves or does
// not. Pure.
[[nodiscard]] Marks marks_of(const Measures& measures, const Measures& reference, bool moves,
                             Reading reading = Reading::Decided) noexcept;

// What metrics are divided by and where gates end, for the files, behind what there is.
void list_gates(std::vector<Parameter>& into);

}  // namespace thimble::lab
