#pragma once

#include <string>
#include <vector>

#include "daemon/config/config.hpp"

namespace thimble::lab {

// What of a configuration cannot be had in virtual time, a sentence each that begins with the key;
// empty: all of it can. Pure.
[[nodiscard]] std::vector<std::string> reasons_not_to_play(const config::Config& config);

}  // namespace thimble::lab
