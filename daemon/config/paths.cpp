#include "daemon/config/paths.hpp"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "daemon/config/socket_place.hpp"

namespace thimble::config {
namespace {

constexpr std::string_view kSocketName = "/thimble.sock";

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
  if (auto path = value_of(environment, "THIMBLE_SOCKET")) return *path;
  if (auto path = value_of(environment, "RUNTIME_DIRECTORY")) {
    return first_of(*path).append(kSocketName);
  }
  if (auto path = value_of(environment, "XDG_RUNTIME_DIR")) return path->append(kSocketName);
  if (environment.user_id == 0) return std::string(kServiceFolder).append(kSocketName);
  return ("/tmp/thimble-" + std::to_string(environment.user_id)).append(kSocketName);
}

std::string client_socket_path(const Environment& environment,
                               const std::function<bool(const std::string&)>& is_there) {
  std::string own = default_socket_path(environment);
  if (value_of(environment, "THIMBLE_SOCKET") || is_there(own)) return own;
  return is_there(kServiceFolder) ? std::string(kServiceFolder).append(kSocketName) : own;
}

bool is_there_and_no_strangers(const std::string& path) {
  return ::access(path.c_str(), F_OK) == 0 && check_socket_place(path);
}

std::string client_socket_path() {
  return client_socket_path(process_environment(), is_there_and_no_strangers);
}

std::string default_flight_directory(const Environment& environment) {
  if (auto path = value_of(environment, "STATE_DIRECTORY")) return first_of(*path);
  if (auto path = value_of(environment, "XDG_STATE_HOME")) return *path + "/thimble";
  if (auto path = value_of(environment, "HOME")) return *path + "/.local/state/thimble";
  return "/var/lib/thimble";
}

}  // namespace thimble::config
