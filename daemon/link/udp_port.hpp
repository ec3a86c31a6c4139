#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "daemon/link/endpoint.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// A UDP socket and a timer on the net plane, for the two ends that speak over it. Includes
// Asio: only for .cpp files of this folder.
//
// One receive and one send are one system call each. The handlers given to start() run until the
// port is destroyed and never after. While datagrams wait, each has a turn of the loop of its own.
//
// Thread: the one that runs the io_context. RT: not.
// Ownership: the io_context must outlive it.
// Errors: opening says why in one sentence; afterwards every error is an outcome, not an end.
class UdpPort {
 public:
  static constexpr std::size_t kMaxDatagram = 1200;  // of any protocol spoken here
  enum class Outcome {
    Done,
    Blocked,  // no room to send: try later
    Failed,   // the system refused
  };
  struct Handlers {
    // `bytes` lives until the call returns. Longer datagrams are cut: still of a wrong size.
    std::function<void(const Endpoint& from, std::span<const std::byte> bytes)> on_datagram;
    std::function<void()> on_receive_error;  // mostly: an earlier datagram was refused (ICMP)
    std::function<void()> on_timer;
  };

  explicit UdpPort(boost::asio::io_context& io);
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  [[nodiscard]] Result<void> open(const Endpoint& bind);
  [[nodiscard]] Endpoint local() const;
  void start(Handlers handlers);

  [[nodiscard]] Outcome send(const Endpoint& to, std::span<const std::byte> bytes);
  // on_timer runs after `wait`, or earlier when that was asked for before.
  void wake_after(MonotonicTime now, Duration wait);
  [[nodiscard]] const std::string& last_error() const noexcept { return last_error_; }

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
  boost::asio::steady_timer timer_;
  std::optional<MonotonicTime> wakes_at_;
  std::shared_ptr<Alive> alive_;
  boost::asio::ip::udp::endpoint sender_;
  std::array<std::byte, kMaxDatagram + 1> buffer_{};  // one more: longer ones show
  std::string last_error_;
};

}  // namespace thimble::link
