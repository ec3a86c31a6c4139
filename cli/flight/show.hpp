#pragma once

#include <string>

namespace thimble::flight {

// `thimble flight show FILE`: writes to standard output, mistakes to standard error; returns the
// exit code.
int run_show(const std::string& file, double before_s);

}  // namespace thimble::flight
