#pragma once

#include <memory>
#include <utility>

#include "drivers/cambus/usb_port.hpp"
#include "sim/model/cam/sim_usb_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::test {

// Until it has said what it is, or that it is none.
inline Result<std::unique_ptr<cambus::UsbPort>> wait_for_board(cambus::UsbOpening opening,
                                                               sim::VirtualClock& clock) {
  while (true) {
    auto port = opening.poll(clock.now());
    if (port || port.error().code != Errc::Busy) return port;
    clock.run_for(std::chrono::microseconds(125));
  }
}

inline std::unique_ptr<cambus::UsbPort> open_usb_port(sim::cam::SimUsbCamBoard& board,
                                                      sim::VirtualClock& clock) {
  const auto match = cambus::match_usb_board(board.info()).value();
  auto device = board.open(match.claim).value();
  return wait_for_board({std::move(device), match}, clock).value();
}

}  // namespace thimble::test
