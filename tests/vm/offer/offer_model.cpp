#include "tests/vm/offer/offer_model.hpp"

#include <fcntl.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <memory>
#include <utility>

#include "hal/linux/monotonic_clock.hpp"
#include "hal/linux/system_error.hpp"
#include "sim/export/acm_on_usb.hpp"
#include "sim/export/hid_on_usb.hpp"
#include "sim/export/plug_pace.hpp"
#include "sim/export/uhid_plug.hpp"
#include "sim/export/vhci_controller.hpp"
#include "sim/export/vhci_plug.hpp"

namespace thimble::test {
namespace {

struct Around {
  linux::MonotonicClock machine;
  sim::VirtualClock clock;
  sim::ModelLog log;
  sim::Misbehaviour misbehaviour{1};
  boost::asio::io_context io;
  [[nodiscard]] sim::PlugSurroundings surroundings() {
    return {&clock, &machine, &log, &misbehaviour};
  }
};

Result<void> run(sim::Plug& plug, Around& around) {
  bool is_over = false;
  boost::asio::signal_set signals(around.io, SIGTERM, SIGINT);
  signals.async_wait([&is_over](auto, int) { is_over = true; });
  if (Result<void> plugged = plug.plug(); !plugged) return plugged;
  std::puts("plugged in");
  std::fflush(stdout);
  sim::PlugPace pace(around.clock, around.machine, plug, {});
  while (!is_over && !plug.is_broken()) {
    pace.run_next();
    around.io.poll();
  }
  return {};
}

Result<void> offer_on_usb(plugin::SimUsbModel& model, sim::UsbPersona persona) {
  Around around;
  sim::VhciPlug plug(
      around.io, model, std::move(persona), around.surroundings(),
      [](int socket, std::uint32_t id) { return sim::VhciController().attach(socket, id); });
  return run(plug, around);
}

Result<void> offer_through_uhid(plugin::SimHidModel& model, const bus::BusDeviceInfo& info) {
  linux::Descriptor node(::open("/dev/uhid", O_RDWR | O_CLOEXEC | O_NONBLOCK));
  if (node.get() < 0) return tl::unexpected(linux::system_error("/dev/uhid", errno));
  Around around;
  sim::UhidPlug plug(std::move(node), model, info, around.surroundings());
  return run(plug, around);
}

}  // namespace

Result<void> offer_model(plugin::SimUsbModel& model, const bus::BusDeviceInfo& info) {
  return offer_on_usb(model, {info, {}});
}

Result<void> offer_model(plugin::SimHidModel& model, const bus::BusDeviceInfo& info, HidWay way) {
  if (way == HidWay::Uhid) return offer_through_uhid(model, info);
  sim::HidOnUsb wrapped(model);
  return offer_on_usb(wrapped, wrapped.persona(info));
}

Result<void> offer_model(plugin::SimSerialModel& model, const bus::BusDeviceInfo& info) {
  sim::AcmOnUsb wrapped(model);
  return offer_on_usb(wrapped, wrapped.persona(info));
}

}  // namespace thimble::test
