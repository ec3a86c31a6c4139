#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "daemon/link/endpoint.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// A place that datagrams are sent from and come to, with a timer, for the two ends that speak over
// one. UdpPort is that of the system; another network, in another time, has ports of its own.
//
// Thread: the one that its network runs on. RT: not. Ownership: the network must outlive it.
// Errors: opening says why in one sentence; afterwards every error is an outcome, not an end.
class DatagramPort {
 public:
  static constexpr std::size_t kMaxDatagram = 1200;  // of any protocol spoken here
  enum class Outcome {
    Done,
    Blocked,  // no room to send: try later
    Failed,   // the system refused
  };
  // They run until the port is destroyed and never after.
  struct Handlers {
    // `bytes` lives until the call returns. Longer datagrams are cut: still of a wrong size.
    std::function<void(const Endpoint& from, std::span<const std::byte> bytes)> on_datagram;
    std::function<void()> on_receive_error;  // mostly: an earlier datagram was refused (ICMP)
    std::function<void()> on_timer;
  };

  DatagramPort() = default;
  virtual ~DatagramPort() = default;
  DatagramPort(const DatagramPort&) = delete;
  DatagramPort& operator=(const DatagramPort&) = delete;

  // Port 0: a free one. Errors: Busy, somebody has it; System.
  [[nodiscard]] virtual Result<void> open(const Endpoint& bind) = 0;
  [[nodiscard]] virtual Endpoint local() const = 0;
  // Once, when open.
  virtual void start(Handlers handlers) = 0;
  [[nodiscard]] virtual Outcome send(const Endpoint& to, std::span<const std::byte> bytes) = 0;
  // on_timer runs after `wait`, or earlier when that was asked for before.
  virtual void wake_after(MonotonicTime now, Duration wait) = 0;
  [[nodiscard]] virtual const std::string& last_error() const noexcept = 0;
};

// Thread: one. RT: not; allocates its ports. Ownership: outlives its ports, which are the caller's.
// Errors: none; a port says its own when it is opened.
class DatagramNetwork {
 public:
  virtual ~DatagramNetwork() = default;
  // Not open yet.
  [[nodiscard]] virtual std::unique_ptr<DatagramPort> make_port() = 0;
};

}  // namespace thimble::link
