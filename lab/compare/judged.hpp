#pragma once

#include <vector>

#include "lab/compare/measures.hpp"
#include "lab/compare/stage.hpp"
#include "lab/trial/coupling_case.hpp"
#include "lab/trial/finger.hpp"

// What the gates G2 to G4 ask of every scenario (decisions 0441 and 0477): of several, `into` keeps
// the worst. SI. Pure. Errors: none; what is not a number stays one, and fails.
namespace thimble::lab {

// SOURCE: decision 0441, of the hand that G3's 2 N are meant for.
inline constexpr double kHandOfRise_m_per_s = 0.2;
// Ours: no hand is as fast as this from one tick to the next, but one that nothing stops turns so.
inline constexpr double kJerk_m_per_s = 0.1;

// The largest force asked for, and both of judge_changes().
void judge_forces(const std::vector<Felt>& history, Measures& into);
// How a force rises in a tick, and how a wall pulls: of a hand that nothing stops, too, which
// decides by itself how deep it is and so how large a force becomes. Where it turns at once what
// rises is its own jerk.
void judge_changes(const std::vector<Felt>& history, Measures& into);
// Energy that the finger was given, beside what the scheme declares for as many contacts and as
// large an offset as the run had: the pair of which more of the declared was given.
void judge_energy(const CouplingCase& of, const std::vector<Felt>& history, const Finger& finger,
                  Measures& into);

}  // namespace thimble::lab
