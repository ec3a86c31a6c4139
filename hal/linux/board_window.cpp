#include "hal/linux/board_window.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <string>

#include "hal/linux/mapped_window.hpp"
#include "hal/linux/passed_descriptors.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::linux {

Result<std::unique_ptr<bus::MemoryWindow>> open_board_window(const std::filesystem::path& socket,
                                                             Duration patience) {
  const std::string path = socket.string();
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(name.sun_path)) {
    return fail(Errc::InvalidArgument, path + ": no name for a socket");
  }
  std::copy(path.begin(), path.end(), static_cast<char*>(name.sun_path));
  const Descriptor connection(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (connection.get() < 0 ||
      ::connect(connection.get(), reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0) {
    return tl::unexpected(system_error(path + " (systemctl status thimble-board.socket)", errno));
  }
  const auto file = receive_descriptor(connection.get(), patience);
  if (!file && file.error().code == Errc::Disconnected) {
    return fail(Errc::NotFound, "no CAM board in a slot (journalctl -u 'thimble-board@*')");
  }
  if (!file) return tl::unexpected(file.error().in(path));
  auto window = MappedWindow::map(*file, "the board's memory");
  if (!window) return tl::unexpected(window.error());
  return std::unique_ptr<bus::MemoryWindow>(*std::move(window));
}

}  // namespace thimble::linux
