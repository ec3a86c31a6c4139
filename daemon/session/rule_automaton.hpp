#pragma once

#include <memory>

#include "daemon/world/cam/automaton.hpp"
#include "hal/base/result.hpp"
#include "sim/model/cam/rules/random_sites.hpp"

namespace thimble::session {

// A rule of a CAM on the fast engine (decision 0342). Matter is the rule's crystal, or where it has
// none its one cell: what is written sets or clears all layers of it.
//
// Thread: one at a time. Not RT: a step of 2^18 cells takes some 0.1 ms, write() and load() 1 ms.
// `rule` must outlive it. Errors: InvalidArgument for a space that cannot be.
[[nodiscard]] Result<std::unique_ptr<world::cam::Automaton>> make_rule_automaton(
    const sim::cam::Rule& rule, const CamAxes& log2_cells, const sim::cam::Beginning& beginning);

}  // namespace thimble::session
