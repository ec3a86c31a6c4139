#pragma once

#include <memory>

#include "daemon/session/board_search.hpp"
#include "daemon/world/cam/piece_board.hpp"
#include "hal/base/time.hpp"
#include "sim/model/cam/sim_usb_cam_board.hpp"

namespace thimble::session {

// Ways to the boards that a world can be on. The opener of a simulated one keeps its board, which
// scans in the thread that asks; `clock` must outlive it.

// In a slot of PCI. Errors of the opener: as cambus::PciPort::open().
[[nodiscard]] world::cam::PieceBoard::Opener open_in_slot(const Clock& clock,
                                                          const sim::cam::BoardOptions& options);

// Behind a plug of USB. Errors of the opener: Busy, it has not said yet what it is: ask again;
// NotFound, it is not plugged in; as cambus::UsbOpening::poll().
[[nodiscard]] world::cam::PieceBoard::Opener open_on_usb(
    std::shared_ptr<sim::cam::SimUsbCamBoard> board);

// Plugged into this machine, the first there is (BoardSearch). Nothing that it does waits for the
// kernel. Errors of the opener: as open_on_usb() and BoardSearch::take().
[[nodiscard]] world::cam::PieceBoard::Opener open_plugged_in(const BoardPlugs& plugs);

// In a slot of PCI of this machine; likewise. Errors of the opener: as open_in_slot(), and of
// `plugs.open_window`.
[[nodiscard]] world::cam::PieceBoard::Opener open_in_real_slot(const BoardPlugs& plugs);

}  // namespace thimble::session
