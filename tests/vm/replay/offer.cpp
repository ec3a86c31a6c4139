#include "tests/vm/replay/offer.hpp"

namespace thimble::replay {

Result<void> offer(const Tape& tape, test::HidWay way) {
  if (tape.info.kind == bus::BusKind::Usb) {
    TapeUsb model(tape);
    return test::offer_model(model, tape.info);
  }
  TapeHid model(tape);
  return test::offer_model(model, tape.info, way);
}

}  // namespace thimble::replay
