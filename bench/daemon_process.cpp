#include "bench/daemon_process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <thread>
#include <vector>

namespace thimble::bench {
namespace {

constexpr auto kPatience = std::chrono::seconds(5);
constexpr auto kPause = std::chrono::microseconds(500);
constexpr std::string_view kRequest =
    "GET /v1/status HTTP/1.1\r\nHost: thimble\r\nConnection: close\r\n\r\n";

// The whole answer, empty when nobody listens.
std::string ask(const std::string& socket_path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, socket_path.c_str(), sizeof address.sun_path - 1);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
  std::string answer;
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::send(fd, kRequest.data(), kRequest.size(), MSG_NOSIGNAL) > 0) {
    std::array<char, 4096> bytes{};
    for (ssize_t n = 0; (n = ::recv(fd, bytes.data(), bytes.size(), 0)) > 0;) {
      answer.append(bytes.data(), static_cast<std::size_t>(n));
    }
  }
  ::close(fd);
  return answer;
}

}  // namespace

DaemonProcess::DaemonProcess() {
  std::array<char, 32> folder{"/tmp/thimble-bench-XXXXXX"};
  if (::mkdtemp(folder.data()) == nullptr) return;
  folder_ = folder.data();
  socket_ = folder_ + "/socket";
  const std::string program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "thimbled";
  std::vector<std::string> words{program,
                                 "--config",
                                 "examples/hello-voxel.toml",
                                 "--set",
                                 "daemon.socket=" + socket_,
                                 "--set",
                                 "daemon.flight_directory=" + folder_};
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t silence;
  ::posix_spawn_file_actions_init(&silence);
  ::posix_spawn_file_actions_addopen(&silence, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_adddup2(&silence, STDOUT_FILENO, STDERR_FILENO);
  if (::posix_spawn(&child_, program.c_str(), &silence, nullptr, arguments.data(), environ) != 0) {
    child_ = 0;
  }
  ::posix_spawn_file_actions_destroy(&silence);
}

DaemonProcess::~DaemonProcess() {
  if (is_started()) {
    ::kill(child_, SIGTERM);
    int status = 0;
    ::waitpid(child_, &status, 0);
  }
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

bool DaemonProcess::has_ticked() const {
  constexpr std::string_view kKey = "\"ticks\":";
  const std::string answer = ask(socket_);
  const std::size_t at = answer.find(kKey);
  return at != std::string::npos && ::strtoll(answer.c_str() + at + kKey.size(), nullptr, 10) > 0;
}

bool DaemonProcess::wait_for_first_tick() const {
  const auto give_up = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < give_up) {
    if (has_ticked()) return true;
    std::this_thread::sleep_for(kPause);
  }
  return false;
}

}  // namespace thimble::bench
