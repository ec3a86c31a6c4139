#include "tests/vm/replay/offer.hpp"

#include "tests/vm/offer/offer_model.hpp"

namespace thimble::replay {

Result<void> offer(const Tape& tape, std::optional<std::uint16_t> usbip_port) {
  if (tape.info.kind == bus::BusKind::Usb) {
    TapeUsb model(tape);
    return test::offer_model(model, tape.info, usbip_port.value_or(0));
  }
  TapeHid model(tape);
  return test::offer_model(model, tape.info, usbip_port);
}

}  // namespace thimble::replay
