#include "daemon/link/udp_network.hpp"

#include "daemon/link/udp_port.hpp"

namespace thimble::link {

std::unique_ptr<DatagramPort> UdpNetwork::make_port() { return std::make_unique<UdpPort>(*io_); }

}  // namespace thimble::link
