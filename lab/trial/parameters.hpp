#pragma once

#include <span>
#include <vector>

#include "lab/findings/findings.hpp"
#include "lab/trial/coupling_case.hpp"
#include "lab/trial/finger.hpp"

// What an experiment ran with, for its files: whoever reads them later has no other place to look.
namespace thimble::lab {

// Of each case every number that its scheme takes, "NAME: number", and no other scheme's. SI.
[[nodiscard]] std::vector<Parameter> parameters_of(std::span<const CouplingCase> cases);
// "finger: number", SI.
[[nodiscard]] std::vector<Parameter> parameters_of(const FingerSettings& finger);

// `all` behind what there is.
void append(std::vector<Parameter>& to, const std::vector<Parameter>& all);

}  // namespace thimble::lab
