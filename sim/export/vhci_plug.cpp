#include "sim/export/vhci_plug.hpp"

#include <sys/socket.h>

#include <array>
#include <boost/system/error_code.hpp>
#include <cerrno>
#include <utility>

#include "hal/linux/descriptor.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::sim {

VhciPlug::VhciPlug(boost::asio::io_context& io, plugin::SimUsbModel& model, UsbPersona persona,
                   const PlugSurroundings& surroundings, Attach attach)
    : UsbipBus(model, std::move(persona), surroundings), io_(&io), attach_(std::move(attach)) {}

Result<void> VhciPlug::tell_host() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return tl::unexpected(linux::system_error("a pair of sockets", errno));
  }
  const linux::Descriptor kernels(ends[1]);
  Socket ours(*io_, boost::asio::generic::stream_protocol(AF_UNIX, 0), ends[0]);
  boost::system::error_code error;
  ours.non_blocking(true, error);
  if (error) return tl::unexpected(linux::system_error("a pair of sockets", error.value()));
  Result<void> done = attach_(kernels.get(), UsbipSession::kDeviceId);
  if (done) connect(std::move(ours)).attach();
  return done;
}

}  // namespace thimble::sim
