#pragma once

#include <filesystem>
#include <memory>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/memory_window.hpp"

namespace thimble::linux {

// The memory of a CAM board on PCI, opened by thimble-board, which listens at `socket`: here nobody
// may open it (docs/decisions/0402-a-root-helper-opens-the-pci-board.md).
// Thread: any; not RT: waits for the helper, `patience` at most. Errors: NotFound, the socket is
// not there, or the helper has no board; Timeout, Permission, Malformed, System; those of
// MappedWindow::map().
[[nodiscard]] Result<std::unique_ptr<bus::MemoryWindow>> open_board_window(
    const std::filesystem::path& socket, Duration patience);

}  // namespace thimble::linux
