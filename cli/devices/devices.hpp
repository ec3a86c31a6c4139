#pragma once

#include <string>

namespace thimble::devices_list {

// `thimble devices`: prints what could be used, why anything cannot, and, where a daemon listens
// at the socket, what it uses. Looks below `root` for what is plugged in. Returns the exit code.
int run_devices(const std::string& socket_path, const std::string& root, bool is_json);

}  // namespace thimble::devices_list
