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
#include "sim/export/usbip_plug.hpp"

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
  sim::PlugPace pace(around.clock, around.machine, plug);
  while (!is_over && !plug.is_broken()) {
    pace.run_next();
    around.io.poll();
  }
  return {};
}

Result<void> offer_by_usbip(plugin::SimUsbModel& model, sim::UsbPersona persona,
                            std::uint16_t port) {
  Around around;
  auto plug =
      sim::UsbipPlug::listen(around.io, port, model, std::move(persona), around.surroundings());
  if (!plug) return tl::unexpected(plug.error());
  return run(**plug, around);
}

Result<void> offer_through_uhid(plugin::SimHidModel& model, const bus::BusDeviceInfo& info) {
  linux::Descriptor node(::open("/dev/uhid", O_RDWR | O_CLOEXEC | O_NONBLOCK));
  if (node.get() < 0) return tl::unexpected(linux::system_error("/dev/uhid", errno));
  Around around;
  sim::UhidPlug plug(std::move(node), model, info, around.surroundings());
  return run(plug, around);
}

}  // namespace

Result<void> offer_model(plugin::SimUsbModel& model, const bus::BusDeviceInfo& info,
                         std::uint16_t usbip_port) {
  return offer_by_usbip(model, {info, {}}, usbip_port);
}

Result<void> offer_model(plugin::SimHidModel& model, const bus::BusDeviceInfo& info,
                         std::optional<std::uint16_t> usbip_port) {
  if (!usbip_port) return offer_through_uhid(model, info);
  sim::HidOnUsb wrapped(model);
  return offer_by_usbip(wrapped, wrapped.persona(info), *usbip_port);
}

Result<void> offer_model(plugin::SimSerialModel& model, const bus::BusDeviceInfo& info,
                         std::uint16_t usbip_port) {
  sim::AcmOnUsb wrapped(model);
  return offer_by_usbip(wrapped, wrapped.persona(info), usbip_port);
}

}  // namespace thimble::test
