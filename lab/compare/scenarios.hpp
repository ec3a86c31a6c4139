#pragma once

#include <vector>

#include "hal/base/result.hpp"
#include "lab/compare/measures.hpp"
#include "lab/findings/findings.hpp"

// One thing that a hand does in front of the wall, each; what it found goes into its fields of
// Measures. Errors: the scheme refuses the world.
namespace thimble::lab {

// A hand that nothing stops, at 0.2 m/s until it feels the wall or is at the end of the arm's
// reach, then to and fro by 2 mm: onset, stiffness, displacement. A finger has used up where it
// wants to be before a wall of long ago is there (teleop.md 3, "Reading"); what it feels then is
// not the wall.
[[nodiscard]] Result<void> play_probe(const CouplingCase& of, const StageSettings& settings,
                                      Measures& into);
// A finger drawn at 0.2 m/s from 30 mm before the wall to 20 mm behind it, 3 s of hold, retreat:
// drag, hold, swing, residue, packets, energy and the gates. SOURCE: teleop.md section 3.
[[nodiscard]] Result<void> play_approach(const CouplingCase& of, const StageSettings& settings,
                                         Measures& into);
// A push of 2 N for 3 s from 1 mm before the wall.
[[nodiscard]] Result<void> play_push(const CouplingCase& of, const StageSettings& settings,
                                     Measures& into);
// 10 mm behind the wall's face, along it at 0.1 m/s and past its edge.
[[nodiscard]] Result<void> play_edge(const CouplingCase& of, const StageSettings& settings,
                                     Measures& into);
// Taps that are 30, 60, 120 and 250 ms behind the face, four of each, by a hand that nothing stops.
[[nodiscard]] Result<void> play_taps(const CouplingCase& of, const StageSettings& settings,
                                     Measures& into);
// Pressing 10 to 30 mm behind the face at 2 Hz, with an outage of 200 ms and without.
[[nodiscard]] Result<void> play_outage(const CouplingCase& of, const StageSettings& settings,
                                       Measures& into);
// To and fro in free space by 5 mm at 2 Hz, by a hand that nothing stops.
[[nodiscard]] Result<void> play_shake(const CouplingCase& of, const StageSettings& settings,
                                      Measures& into);
// A finger that is held 20 mm behind the face of a wall that moves, for many of its periods.
[[nodiscard]] Result<void> play_hold(const CouplingCase& of, const StageSettings& settings,
                                     Measures& into);

// The numbers of all of them, behind what there is: by file.
void list_probe(std::vector<Parameter>& into);
void list_approach(std::vector<Parameter>& into);
void list_presses(std::vector<Parameter>& into);  // push, edge, outage
void list_motions(std::vector<Parameter>& into);  // taps, shake
void list_hold(std::vector<Parameter>& into);

}  // namespace thimble::lab
