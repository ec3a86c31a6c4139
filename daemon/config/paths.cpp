#include "daemon/config/paths.hpp"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <optional>
#include <string_view>

namespace thimble::config {
namespace {

constexpr std::array kVariables = {"THIMBLE_SOCKET",  "RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR",
                                   "STATE_DIRECTORY", "XDG_STATE_HOME",    "HOME"};

std::optional<std::string> value_of(const Environment& environment, const char* name) {
  const auto found = environment.variables.find(name);
  if (found == environment.variables.end() || found->second.empty()) return std::nullopt;
  return found->second;
}

// systemd separates several directories by colons; the first is ours.
std::string first_of(const std::string& directories) {
  return directories.substr(0, directories.find(':'));
}

}  // namespace

Environment process_environment() {
  Environment environment;
  environment.user_id = ::geteuid();
  for (const char* name : kVariables) {
    if (const char* value = std::getenv(name)) environment.variables[name] = value;
  }
  return environment;
}

std::string default_socket_path(const Environment& environment) {
  constexpr std::string_view kName = "/thimble.sock";
  if (auto path = value_of(environment, "THIMBLE_SOCKET")) return *path;
  if (auto path = value_of(environment, "RUNTIME_DIRECTORY")) {
    return first_of(*path).append(kName);
  }
  if (auto path = value_of(environment, "XDG_RUNTIME_DIR")) return path->append(kName);
  if (environment.user_id == 0) return "/run/thimble/thimble.sock";
  return ("/tmp/thimble-" + std::to_string(environment.user_id)).append(kName);
}

std::string default_flight_directory(const Environment& environment) {
  if (auto path = value_of(environment, "STATE_DIRECTORY")) return first_of(*path);
  if (auto path = value_of(environment, "XDG_STATE_HOME")) return *path + "/thimble";
  if (auto path = value_of(environment, "HOME")) return *path + "/.local/state/thimble";
  return "/var/lib/thimble";
}

}  // namespace thimble::config
