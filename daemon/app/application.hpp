#pragma once

#include "daemon/app/options.hpp"

namespace thimble::app {

// The daemon from its configuration to its end; returns the exit code (exit_code.hpp).
// Everything a person must know is printed on standard error; standard output stays empty
// but for --check.
int run(const Options& options);

// The last thing before the end: the exit code, or kExitFailure and one sentence on standard error
// when what was printed could not be written.
int finish(int code);

}  // namespace thimble::app
