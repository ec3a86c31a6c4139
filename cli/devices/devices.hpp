#pragma once

#include <string>
#include <vector>

namespace thimble::devices_list {

struct DevicesOptions {
  std::string socket_path;
  std::string root{"/"};             // where to look for what is plugged in
  std::vector<std::string> plugins;  // to be loaded and listed with the rest
  bool is_json{false};
};

// `thimble devices`: prints what could be used, why anything cannot, and, where a daemon listens
// at the socket, what it uses. Returns the exit code: kExitRefused, and nothing is listed, when a
// plugin cannot be had.
int run_devices(const DevicesOptions& options);

}  // namespace thimble::devices_list
