#include "cli/doctor/daemon_socket.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "cli/client.hpp"
#include "cli/doctor/file_tree.hpp"

namespace thimble::doctor {
namespace {

namespace fs = std::filesystem;

// Whether somebody else may have made the folder, as anybody can make /tmp/thimble-UID before its
// user does (daemon/api/socket_file.cpp refuses such a one, too).
bool is_of_a_stranger(const fs::path& folder) {
  struct stat info {};
  struct stat above {};
  if (::stat(folder.c_str(), &info) != 0) return false;
  if (info.st_uid == 0 || info.st_uid == ::geteuid()) return false;
  return ::stat(folder.parent_path().c_str(), &above) != 0 || (above.st_mode & S_IWOTH) != 0;
}

}  // namespace

DaemonAtSocket who_listens(const fs::path& root, const std::string& socket_path) {
  if (!is_this_machine(root)) return {};
  const fs::path folder = fs::absolute(socket_path).parent_path();
  if (is_of_a_stranger(folder)) {
    return {std::nullopt, "the folder " + folder.string() +
                              " belongs to another user, who may have put any socket there"};
  }
  const auto client = cli::Client::connect(socket_path, std::chrono::seconds(1));
  if (!client) {
    const bool is_nobody = client.error().code == Errc::NotFound;
    return {std::nullopt, is_nobody ? std::string() : client.error().message};
  }
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt((*client)->descriptor(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return {std::nullopt,
            "who listens at " + socket_path + " is not told: " + std::strerror(errno)};
  }
  // A process that is in none of the name spaces seen from here has no number.
  if (peer.pid > 0) return {peer.pid, ""};
  return {std::nullopt, "the daemon at " + socket_path + " runs outside of this container"};
}

}  // namespace thimble::doctor
