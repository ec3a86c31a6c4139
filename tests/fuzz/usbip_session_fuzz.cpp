#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "sim/export/usbip_session.hpp"
#include "sim/model/falcon/register_falcon_model.hpp"

// A host that says anything to a Falcon, in pieces whose lengths the first byte chooses: nothing
// waits without bound, and what is answered are whole headers.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::sim;
  if (size == 0) return 0;
  static const auto kRegistry = [] {
    thimble::plugin::SimModelRegistry models;
    register_falcon_model(models);
    return models;
  }();
  const auto model = *kRegistry.find("falcon")->create_usb({});
  VirtualClock clock;
  ModelLog log(64);
  Misbehaviour misbehaviour(1);
  const UsbPersona persona{model->describe(), {}};
  UsbipSession session(*model, persona, 8, {&clock, &clock, &log, &misbehaviour});
  session.set_available(true);
  const std::size_t piece = 1 + data[0];
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  while (!rest.empty()) {
    const std::size_t now = std::min(piece, rest.size());
    if (!session.take(rest.first(now))) return 0;
    rest = rest.subspan(now);
    clock.run_for(std::chrono::microseconds(125));
    model->advance(clock.now());
    session.serve(clock.now());
    if (session.waiting() > UsbipSession::kMaxTransfers) std::abort();
    if (session.outbox().size() >
        UsbipSession::kMaxOutboxBytes + 2 * UsbipSession::kMaxTransferBytes)
      std::abort();
    session.outbox().clear();
  }
  return 0;
}
