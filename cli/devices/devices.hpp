#pragma once

#include <string>
#include <vector>

namespace thimble::devices_list {

enum class Form { Text, Json, Toml };

struct DevicesOptions {
  std::string socket_path;
  std::string root{"/"};             // where to look for what is plugged in
  std::vector<std::string> plugins;  // to be loaded and listed with the rest
  Form form{Form::Text};
};

// `thimble devices`: prints what could be used, why anything cannot, and, where a daemon listens
// at the socket, what it uses. Returns the exit code: kExitRefused, and nothing is listed, when a
// plugin cannot be had. As Toml: the tables that a configuration lacks (arm_tables.hpp).
int run_devices(const DevicesOptions& options);

}  // namespace thimble::devices_list
