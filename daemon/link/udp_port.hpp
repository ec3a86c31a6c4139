#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "daemon/link/datagram_port.hpp"
#include "daemon/link/wake_timer.hpp"

namespace thimble::link {

// A UDP socket and a timer of the system. Includes Asio: only for .cpp files of this folder.
//
// One receive and one send are one system call each. While datagrams wait, each has a turn of the
// loop of its own.
//
// Thread: the one that runs the io_context, which must outlive it. The rest: see DatagramPort.
class UdpPort final : public DatagramPort {
 public:
  explicit UdpPort(boost::asio::io_context& io);
  ~UdpPort() override;

  [[nodiscard]] Result<void> open(const Endpoint& bind) override;
  [[nodiscard]] Endpoint local() const override;
  void start(Handlers handlers) override;
  [[nodiscard]] Outcome send(const Endpoint& to, std::span<const std::byte> bytes) override;
  void wake_after(MonotonicTime now, Duration wait) override;
  [[nodiscard]] const std::string& last_error() const noexcept override { return last_error_; }

 private:
  // Shared with the handlers that Asio still holds when the port is gone: they look here
  // whether it is.
  struct Alive {
    Handlers handlers;
  };

  void receive_next();
  void note_error(const char* what, const boost::system::error_code& error);

  // Asio's own socket type has an executor of any type, which costs at each operation.
  using Socket = boost::asio::basic_datagram_socket<boost::asio::ip::udp,
                                                    boost::asio::io_context::executor_type>;

  Socket socket_;
  WakeTimer timer_;
  std::shared_ptr<Alive> alive_;
  boost::asio::ip::udp::endpoint sender_;
  std::array<std::byte, kMaxDatagram + 1> buffer_{};  // one more: longer ones show
  std::string last_error_;
};

}  // namespace thimble::link
