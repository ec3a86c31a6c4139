#pragma once

#include <memory>

#include "daemon/link/datagram_port.hpp"

namespace boost::asio {
class io_context;
}

namespace thimble::link {

// The sockets of this machine (UdpPort). Thread: the one that runs the io_context. RT: not.
// Ownership: the io_context must outlive it and its ports, which do not need it themselves.
// Errors: none here; UdpPort's when one opens.
class UdpNetwork final : public DatagramNetwork {
 public:
  explicit UdpNetwork(boost::asio::io_context& io) noexcept : io_(&io) {}
  [[nodiscard]] std::unique_ptr<DatagramPort> make_port() override;

 private:
  boost::asio::io_context* io_;
};

}  // namespace thimble::link
