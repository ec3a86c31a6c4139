#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <memory>

#include "sim/export/usbip_bus.hpp"

namespace thimble::sim {

// Offers a simulated USB device by USB/IP on this machine's loopback: `usbip attach -r 127.0.0.1 -b
// 1-1`. It needs no rights; who attaches does. While a host has the device some more may ask what
// there is, and are let in once in 50 frames. Unplugged, nothing is offered.
//
// Thread, Errors: as Plug. RT: none of it. Ownership: as UsbipBus.
class UsbipPlug final : public UsbipBus {
 public:
  // `port` 0: one that is free. Errors: Busy when it is taken, else System.
  [[nodiscard]] static Result<std::unique_ptr<UsbipPlug>> listen(
      boost::asio::io_context& io, std::uint16_t port, plugin::SimUsbModel& model,
      UsbPersona persona, const PlugSurroundings& surroundings);
  [[nodiscard]] std::uint16_t port() const;

 private:
  using Tcp = boost::asio::ip::tcp;
  UsbipPlug(boost::asio::io_context& io, plugin::SimUsbModel& model, UsbPersona persona,
            const PlugSurroundings& surroundings);
  Result<void> tell_host() override { return {}; }  // it asks
  void end_frame(std::uint64_t frame) noexcept override;

  boost::asio::io_context* io_;
  Tcp::acceptor acceptor_;
};

}  // namespace thimble::sim
