#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace thimble::config {

// The part of a process's surroundings that decides where its files are.
struct Environment {
  std::map<std::string, std::string> variables;
  std::uint32_t user_id{0};
};

// Those of the calling process. Thread: while no other thread changes the environment.
[[nodiscard]] Environment process_environment();

// Where daemon and command line meet when nobody says otherwise: $THIMBLE_SOCKET, else
// thimble.sock in $RUNTIME_DIRECTORY, else in $XDG_RUNTIME_DIR, else /run/thimble/ for root,
// else /tmp/thimble-UID/. Empty variables count as unset.
[[nodiscard]] std::string default_socket_path(const Environment& environment);

// Where the command line looks for a daemon when nobody says: $THIMBLE_SOCKET, else the default
// above where a socket is, else that of the system's service where its folder is, else the default.
// `is_there` says whether a path exists: not for what lies in a folder that may not be entered,
// and so the folder is asked for, which the service manager removes with the service.
[[nodiscard]] std::string client_socket_path(
    const Environment& environment, const std::function<bool(const std::string&)>& is_there);
// The `is_there` of this machine: what a stranger may have put there is not (check_socket_place).
[[nodiscard]] bool is_there_and_no_strangers(const std::string& path);
// For the calling process. Thread: as process_environment().
[[nodiscard]] std::string client_socket_path();

// RuntimeDirectory= of systemd/thimbled.service.
inline constexpr const char* kServiceFolder = "/run/thimble";

// Where flight recordings go: $STATE_DIRECTORY, else thimble in $XDG_STATE_HOME, else
// ~/.local/state/thimble, else /var/lib/thimble.
[[nodiscard]] std::string default_flight_directory(const Environment& environment);

}  // namespace thimble::config
