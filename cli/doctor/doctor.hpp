#pragma once

#include <string>
#include <vector>

namespace thimble::doctor {

struct DoctorOptions {
  std::string root{"/"};             // the machine
  std::vector<std::string> plugins;  // whose arms are looked at, too
  bool is_json{false};
  // A configuration file, whose plugins, servo and socket count; empty: that of the service.
  std::string config;
  std::string socket_path{};  // of the daemon; empty: that of the configuration, else the usual one
};

// `thimble doctor`: examines a machine and prints what it found. Returns the exit code:
// kExitRefused (cli/commands.hpp) when something is wrong, or, with nothing printed, when a plugin
// of the options cannot be had; a warning is kExitOk.
int run_doctor(const DoctorOptions& options);

}  // namespace thimble::doctor
