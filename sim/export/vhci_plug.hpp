#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>

#include "hal/base/result.hpp"
#include "sim/export/usbip_bus.hpp"

namespace thimble::sim {

// Plugs a simulated USB device into this machine's own kernel, by USB/IP through a pair of sockets
// of which the kernel has the other end: neither a port nor the program usbip is needed, and a
// transfer costs no way through the network's stack (decision 0468).
//
// Who detaches it on the kernel's side has pulled its cable; unplug() and plug() plug it in again.
// Thread: as Plug. RT: none of it. Ownership: as UsbipBus. Errors of plug(): Busy when it is
// plugged in already, and those of `attach`, which is VhciController's but for tests.
class VhciPlug final : public UsbipBus {
 public:
  // Gives the kernel its end, of which it has a hold of its own when this returns.
  using Attach = std::function<Result<void>(int socket, std::uint32_t device_id)>;

  VhciPlug(boost::asio::io_context& io, plugin::SimUsbModel& model, UsbPersona persona,
           const PlugSurroundings& surroundings, Attach attach);

 private:
  Result<void> tell_host() override;
  void end_frame(std::uint64_t) noexcept override {}  // nobody comes but by plug()

  boost::asio::io_context* io_;
  Attach attach_;
};

}  // namespace thimble::sim
