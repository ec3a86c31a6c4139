#pragma once

#include <string>

namespace thimble::doctor {

// `thimble doctor`: examines the machine below `root` and prints what it found. Returns the exit
// code: kExitRefused (cli/commands.hpp) when something is wrong; a warning is kExitOk.
int run_doctor(const std::string& root, bool is_json);

}  // namespace thimble::doctor
