#include "cli/service_state.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>

extern char** environ;  // NOLINT: what a child is given; posix_spawn asks for it

namespace thimble::cli {
namespace {

constexpr int kPatience_ms = 2000;  // ours: a manager that answers at all answers at once

// The value of a line "KEY=VALUE" that is all of small letters, digits and '-', as those of
// systemd are; else empty.
std::string value_of(std::string_view text, std::string_view key) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (!line.starts_with(key) || line.substr(key.size(), 1) != "=") continue;
    const std::string_view value = line.substr(key.size() + 1);
    constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyz0123456789-";
    return value.find_first_not_of(kPlain) == std::string_view::npos ? std::string(value) : "";
  }
  return "";
}

// What is written into a pipe until it is closed, or until nothing more came for too long.
std::string read_all(int pipe) {
  std::string text;
  std::array<char, kMaxServiceText> piece{};
  pollfd wanted{pipe, POLLIN, 0};
  while (text.size() < kMaxServiceText && ::poll(&wanted, 1, kPatience_ms) > 0) {
    const ssize_t got = ::read(pipe, piece.data(), piece.size());
    if (got <= 0) return text;
    text.append(piece.data(), static_cast<std::size_t>(got));
  }
  return "";  // late or endless: no answer
}

pid_t start_systemctl(int output) {
  std::array<std::string, 4> words{"systemctl", "show", "thimbled.service",
                                   "--property=LoadState,ActiveState,Result,ExecMainStatus"};
  std::array<char*, 5> arguments{words[0].data(), words[1].data(), words[2].data(), words[3].data(),
                                 nullptr};
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t pid = 0;
  const int failed =
      ::posix_spawnp(&pid, words[0].c_str(), &files, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  return failed != 0 ? 0 : pid;
}

}  // namespace

std::optional<ServiceState> parse_service_state(std::string_view text) {
  if (text.size() > kMaxServiceText || value_of(text, "LoadState") != "loaded") return std::nullopt;
  ServiceState state{value_of(text, "ActiveState"), value_of(text, "Result"), 0};
  if (state.active.empty()) return std::nullopt;
  const std::string status = value_of(text, "ExecMainStatus");
  std::from_chars(status.data(), status.data() + status.size(), state.exit_status);
  return state;
}

std::optional<ServiceState> read_service_state() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  const pid_t pid = start_systemctl(ends[1]);
  ::close(ends[1]);
  const std::string text = pid > 0 ? read_all(ends[0]) : "";
  ::close(ends[0]);
  if (pid > 0) {
    if (text.empty()) ::kill(pid, SIGKILL);
    while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  return parse_service_state(text);
}

std::string advice_without_daemon(const std::optional<ServiceState>& service) {
  if (!service) return "start one with: thimbled --config FILE";
  if (service->active == "failed") {
    return "the service thimbled has failed (" + service->result +
           "): thimble doctor and journalctl -u thimbled say why";
  }
  if (service->active == "inactive") return "start the service with: sudo systemctl start thimbled";
  if (service->active == "active") {
    return "but the service thimbled is active: does its configuration name another socket?";
  }
  return "the service thimbled is " + service->active + ": systemctl status thimbled says more";
}

}  // namespace thimble::cli
