#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "sim/export/acm_on_usb.hpp"
#include "sim/export/hid_on_usb.hpp"
#include "sim/export/usbip_session.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "sim/model/arm/text_arm_model.hpp"
#include "sim/model/falcon/register_falcon_model.hpp"

namespace {

using namespace thimble::sim;

// In pieces of a length: nothing waits without bound.
void say(std::span<const std::uint8_t> rest, std::size_t piece, thimble::plugin::SimUsbModel& model,
         const UsbPersona& persona) {
  VirtualClock clock;
  ModelLog log(64);
  Misbehaviour misbehaviour(1);
  UsbipSession session(model, persona, 8, {&clock, &clock, &log, &misbehaviour});
  session.set_available(true);
  while (!rest.empty()) {
    const std::size_t now = std::min(piece, rest.size());
    if (!session.take(rest.first(now))) return;
    rest = rest.subspan(now);
    clock.run_for(std::chrono::microseconds(125));
    model.advance(clock.now());
    session.serve(clock.now());
    if (session.waiting() > UsbipSession::kMaxTransfers) std::abort();
    if (session.outbox().size() >
        UsbipSession::kMaxOutboxBytes + 2 * UsbipSession::kMaxTransferBytes)
      std::abort();
    session.outbox().clear();
  }
}

}  // namespace

// A host that says anything to a Falcon, and the same to an arm on a serial port and to a HID arm.
// The first byte chooses the length of the pieces.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const auto kRegistry = [] {
    thimble::plugin::SimModelRegistry models;
    register_falcon_model(models);
    register_text_arm_models(models);
    register_arm_models(models);
    return models;
  }();
  const std::size_t piece = 1 + data[0];
  const std::span<const std::uint8_t> rest(data + 1, size - 1);
  const auto falcon = *kRegistry.find("falcon")->create_usb({});
  say(rest, piece, *falcon, {falcon->describe(), {}});

  const auto serial = *kRegistry.find("phantom-vintage-serial")->create_serial({});
  AcmOnUsb acm(*serial);
  say(rest, piece, acm, acm.persona(acm.describe()));

  const auto arm = *kRegistry.find("phantom-vintage")->create_hid({});
  HidOnUsb hid(*arm);
  say(rest, piece, hid, hid.persona(hid.describe()));
  return 0;
}
