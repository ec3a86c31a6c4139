#include "daemon/link/tty_ports.hpp"

#include <utility>

#include "daemon/link/tty_port.hpp"

namespace thimble::link {

TtyPorts::TtyPorts(boost::asio::io_context& io, OpenLine open) : io_(&io), open_(std::move(open)) {}

std::unique_ptr<LinePort> TtyPorts::make_port(const std::string& node, std::uint32_t bit_per_s) {
  return std::make_unique<TtyPort>(
      *io_, [open = open_, node, bit_per_s] { return open(node, bit_per_s); });
}

}  // namespace thimble::link
