#pragma once

#include <string>
#include <vector>

#include "cli/doctor/daemon_socket.hpp"
#include "cli/doctor/facts.hpp"
#include "cli/doctor/file_tree.hpp"

namespace thimble::doctor {

// Fills `process`, `namesakes` and `daemon_trouble`. The daemon is the process that listens at the
// socket, else one that runs the program `thimbled` of a folder that is trusted: the system's, or
// the one where this very program is. What a process calls itself proves nothing.
// Thread: any. Not RT.
void read_daemon(const FileTree& tree, const std::vector<int>& pids, const DaemonAtSocket& socket,
                 Facts& facts);

// As far as a finding names it; without the name of its user.
[[nodiscard]] NamedProcess named_process(const FileTree& tree, int pid);
// The daemon of `facts`, or the guard: by its program, and by its account, which is that of its
// service, the daemon's (where none runs: that of who asks) or root's.
[[nodiscard]] bool is_ours(const FileTree& tree, const NamedProcess& process, const Facts& facts);

}  // namespace thimble::doctor
