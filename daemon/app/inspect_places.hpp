#pragma once

#include <vector>

#include "daemon/config/load.hpp"

namespace thimble::app {

// What a start would stumble over of the socket's place, by its keys: a path that is too long or
// taken by something else, a group that is not there. Makes nothing and connects to nothing;
// rights, and another daemon, are found at the start. Thread: any. Not RT.
[[nodiscard]] std::vector<config::Objection> inspect_socket(const config::Config& config);

// Whether recordings would lie beneath a file. No start looks: it ends for no recording.
[[nodiscard]] std::vector<config::Objection> inspect_recordings(const config::Config& config);

}  // namespace thimble::app
