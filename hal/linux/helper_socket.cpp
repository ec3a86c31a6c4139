#include "hal/linux/helper_socket.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <string>

#include "hal/linux/system_error.hpp"

namespace thimble::linux {

Result<Descriptor> connect_to_helper(const std::filesystem::path& socket, std::string_view advice) {
  const std::string path = socket.string();
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(name.sun_path)) {
    return fail(Errc::InvalidArgument, path + ": no name for a socket");
  }
  std::copy(path.begin(), path.end(), static_cast<char*>(name.sun_path));
  Descriptor connection(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (connection.get() < 0 ||
      ::connect(connection.get(), reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0) {
    return tl::unexpected(system_error(path + " " + std::string(advice), errno));
  }
  return connection;
}

}  // namespace thimble::linux
