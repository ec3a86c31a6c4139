#include "cli/doctor/read_daemon.hpp"

#include <algorithm>
#include <string_view>

#include "cli/doctor/proc_text.hpp"

namespace thimble::doctor {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDaemon = "thimbled";
constexpr std::string_view kGuard = "thimble-guard";
constexpr std::string_view kGuardUnit = "thimble-guard@";  // systemd/thimble-guard@.service

fs::path folder_of(int pid) { return fs::path("/proc") / std::to_string(pid); }

// Whether a process runs that program, by device and inode: what /proc/PID/exe reads as is a path
// in the name space of the process, which it may have made itself.
bool runs(const FileTree& tree, int pid, std::string_view program) {
  std::vector<fs::path> folders{"/usr/bin", "/usr/sbin", "/usr/local/bin", "/usr/local/sbin"};
  const fs::path own = tree.link("/proc/self/exe");
  if (own.is_absolute()) folders.push_back(own.parent_path());
  return std::any_of(folders.begin(), folders.end(), [&](const fs::path& folder) {
    return tree.is_same_file(folder_of(pid) / "exe", folder / program);
  });
}

Process process_in(const FileTree& tree, const fs::path& folder) {
  Process process;
  parse_status(tree.text(folder / "status"), process);
  process.unit = parse_service(tree.text(folder / "cgroup"));
  const std::string limits = tree.text(folder / "limits");
  if (const auto row = parse_limit(limits, "Max realtime priority")) process.rtprio = row->soft;
  if (const auto row = parse_limit(limits, "Max locked memory")) process.memlock = row->hard;
  return process;
}

}  // namespace

NamedProcess named_process(const FileTree& tree, int pid) {
  Process owner;
  parse_status(tree.text(folder_of(pid) / "status"), owner);
  return {pid, trimmed(tree.text(folder_of(pid) / "comm")), owner.user, ""};
}

bool is_ours(const FileTree& tree, const NamedProcess& process, const Facts& facts) {
  if (process.pid == facts.process.pid) return true;
  if (!runs(tree, process.pid, kGuard)) return false;
  // systemd's user for it changes from start to start, so there the unit is the account: into a
  // group of the system's services nobody but root puts a process.
  const std::string unit = parse_service(tree.text(folder_of(process.pid) / "cgroup"));
  return process.user == 0 || process.user == facts.process.user || unit.starts_with(kGuardUnit);
}

void read_daemon(const FileTree& tree, const std::vector<int>& pids, const DaemonAtSocket& socket,
                 Facts& facts) {
  facts.daemon_trouble = socket.trouble;
  KnownBy known_by = KnownBy::Socket;
  int pid = socket.pid.value_or(0);
  if (pid == 0) {
    known_by = KnownBy::Program;
    const auto found =
        std::find_if(pids.begin(), pids.end(), [&](int one) { return runs(tree, one, kDaemon); });
    if (found != pids.end()) pid = *found;
  }
  if (pid != 0 && tree.text(folder_of(pid) / "status").empty()) {
    facts.daemon_trouble = "the rights of thimbled (process " + std::to_string(pid) +
                           ") are not shown: /proc hides them, or it has just ended";
    pid = 0;
  }
  facts.process = process_in(tree, pid == 0 ? fs::path("/proc/self") : folder_of(pid));
  facts.process.pid = pid;
  if (pid != 0) facts.process.known_by = known_by;
  for (const int one : pids) {
    if (one == pid || trimmed(tree.text(folder_of(one) / "comm")) != kDaemon) continue;
    if (!runs(tree, one, kDaemon)) facts.namesakes.push_back(named_process(tree, one));
  }
}

}  // namespace thimble::doctor
