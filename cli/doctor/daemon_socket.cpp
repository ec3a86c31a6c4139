#include "cli/doctor/daemon_socket.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "cli/client.hpp"
#include "cli/doctor/file_tree.hpp"

namespace thimble::doctor {
DaemonAtSocket who_listens(const std::filesystem::path& root, const std::string& socket_path) {
  if (!is_this_machine(root)) return {};
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
