#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace thimble::doctor {

// What the socket of the API tells of the daemon.
struct DaemonAtSocket {
  std::optional<int> pid;  // of the process that listens; the kernel says so, not the process
  std::string trouble;     // why it is not known or not believed, though something is there
  bool operator==(const DaemonAtSocket&) const = default;
};

// Connects, asks the kernel who is at the other end (SO_PEERCRED, unix(7)) and sends nothing. Of a
// `root` other than "/" no socket can tell: nothing.
// Thread: any. Not RT: waits up to a second.
[[nodiscard]] DaemonAtSocket who_listens(const std::filesystem::path& root,
                                         const std::string& socket_path);

}  // namespace thimble::doctor
