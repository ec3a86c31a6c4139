#pragma once

#include <string>
#include <vector>

#include "cli/doctor/verdict.hpp"

namespace thimble::doctor {

// For a person: lines of at most 80 columns; only commands are never cut.
[[nodiscard]] std::string render(const std::vector<Verdict>& verdicts);
// {"checks": [{"check", "level", "finding", "reason", "command", "advice",
// "look_with"}], "wrong": BOOL}
[[nodiscard]] std::string to_json(const std::vector<Verdict>& verdicts);

}  // namespace thimble::doctor
