#pragma once

#include "hal/base/result.hpp"
#include "lab/compare/bounded.hpp"
#include "lab/compare/ranking.hpp"
#include "lab/compare/stage.hpp"

namespace thimble::lab {

// What one scheme made of one network, in the scenarios of teleop.md sections 3 and 5. SI. NaN
// where nothing was felt that could be measured.
struct Measures {
  double onset_s{0};                 // from the true contact until 0.5 N
  double stiffness_newton_per_m{0};  // felt, in the first 5 mm
  double displacement_m{0};          // of the place where 0.5 N are felt
  double drag_newton{0};             // in free space at 0.2 m/s
  double mass_kg{0};                 // felt in free space at 2 Hz
  double push_error_newton{0};       // RMS, of a hand that pushes with 2 N
  double hold_newton{0};             // mean, of a hand that holds a place
  double swing_m{0};                 // of that hand, peak to peak in its last second
  double residue_newton{0};          // mean, after it has left
  double edge_m{0};                  // past the edge, where the wall is last felt
  double missed_share{0};            // of taps
  double astray_newton{0};           // most, by an outage
  double astray_s{0};                // after its end
  double packets_per_s{0};           // both directions
  double bytes_per_s{0};             // of them, as datagrams of ours in the clear
  double generated_joule{0};         // given to the hand, where most of the declared was
  double declared_joule{0};          // what the scheme may there
  double most_newton{0};
  double most_rise_newton{0};  // in a tick
  double most_jump_newton{0};  // of that, without what a hand faster than 0.2 m/s adds: judged.cpp
  double most_pull_newton{0};  // towards the wall, in contact
  HeldAtWall held{};           // before a wall that moves; no mark and no gate: decision 0465
};

// SOURCE: teleop.md section 5, G3: what the arm gives.
inline constexpr double kMost_newton = 8.5;

// Plays all scenarios. Deterministic. Errors: the scheme refuses the world.
[[nodiscard]] Result<Measures> measure(const CouplingCase& of, const StageSettings& settings);

// `reference`: of the reference scheme at no delay, in the same world, whose front moves or does
// not. Pure.
[[nodiscard]] Marks marks_of(const Measures& measures, const Measures& reference,
                             bool moves) noexcept;

}  // namespace thimble::lab
