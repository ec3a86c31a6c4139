#include "hal/linux/board_window.hpp"

#include "hal/linux/helper_socket.hpp"
#include "hal/linux/mapped_window.hpp"
#include "hal/linux/passed_descriptors.hpp"

namespace thimble::linux {

Result<std::unique_ptr<bus::MemoryWindow>> open_board_window(const std::filesystem::path& socket,
                                                             Duration patience) {
  const auto connection = connect_to_helper(socket, "(systemctl status thimble-board.socket)");
  if (!connection) return tl::unexpected(connection.error());
  const auto file = receive_descriptor(connection->get(), patience);
  if (!file && file.error().code == Errc::Disconnected) {
    return fail(Errc::NotFound, "no CAM board in a slot (journalctl -u 'thimble-board@*')");
  }
  if (!file) return tl::unexpected(file.error().in(socket.string()));
  auto window = MappedWindow::map(*file, "the board's memory");
  if (!window) return tl::unexpected(window.error());
  return std::unique_ptr<bus::MemoryWindow>(*std::move(window));
}

}  // namespace thimble::linux
