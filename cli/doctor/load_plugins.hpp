#pragma once

#include <string>
#include <vector>

#include "daemon/session/plugins.hpp"

namespace thimble::doctor {

// Adds what the shared objects bring, whose code runs; a relative path means the working folder.
// Says on standard error what cannot be had, and returns false then.
// Thread: any. Not RT.
[[nodiscard]] bool load_plugins(session::Plugins& plugins, const std::vector<std::string>& paths);

}  // namespace thimble::doctor
