#include "sim/export/usbip_plug.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <utility>

namespace thimble::sim {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

// Ours: the kernel makes a socket before it sees that nobody waits for one, which in each frame of
// a driven device is a good part of all that this program does.
constexpr std::uint64_t kFramesBetweenAccepts = 50;

}  // namespace

UsbipPlug::UsbipPlug(asio::io_context& io, plugin::SimUsbModel& model, UsbPersona persona,
                     const PlugSurroundings& surroundings)
    : UsbipBus(model, std::move(persona), surroundings), io_(&io), acceptor_(io) {}

Result<std::unique_ptr<UsbipPlug>> UsbipPlug::listen(asio::io_context& io, std::uint16_t port,
                                                     plugin::SimUsbModel& model, UsbPersona persona,
                                                     const PlugSurroundings& surroundings) {
  std::unique_ptr<UsbipPlug> plug(new UsbipPlug(io, model, std::move(persona), surroundings));
  error_code error;
  Tcp::acceptor& acceptor = plug->acceptor_;
  acceptor.open(Tcp::v4(), error);
  if (!error) acceptor.set_option(Tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind({asio::ip::address_v4::loopback(), port}, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (!error) acceptor.non_blocking(true, error);
  if (error) {
    const bool is_taken = error == asio::error::address_in_use;
    return fail(is_taken ? Errc::Busy : Errc::System,
                "port " + std::to_string(port) + ": " + error.message());
  }
  return plug;
}

std::uint16_t UsbipPlug::port() const { return acceptor_.local_endpoint().port(); }

// With a frame, so that a host's frames begin with ours.
void UsbipPlug::end_frame(std::uint64_t frame) noexcept {
  if (is_attached() && frame % kFramesBetweenAccepts != 0) return;
  error_code error;
  Tcp::socket socket = acceptor_.accept(*io_, error);
  if (error || !make_room()) return;
  socket.non_blocking(true, error);
  if (!error) socket.set_option(Tcp::no_delay(true), error);
  if (!error) connect(Socket(std::move(socket)));
}

}  // namespace thimble::sim
