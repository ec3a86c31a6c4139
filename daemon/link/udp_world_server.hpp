#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/datagram_port.hpp"
#include "daemon/link/endpoint.hpp"
#include "daemon/link/impairment.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/link_key.hpp"
#include "daemon/link/thimble_world_end.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace boost::asio {
class io_context;
}

namespace thimble::link {

// The world's end of both protocols on one port: ThesisWorldEnd and ThimbleWorldEnd behind a
// socket, told apart by the first bytes of each datagram. Every reply is sent, if need be when
// there is room again; errors are counted and end nothing.
//
// Programs of 1999 are answered on loopback, where there is no key, and wherever their one peer is
// pinned and allowed; our own without a key likewise, with one from anywhere (decision 0427).
//
// Thread: the one that runs the network. RT: not; one receive, one send a message, no
// allocation. Ownership: io_context or network, clock and worlds must outlive it.
// Errors: open() when it may not listen there (may_listen(), without a key) or the port is taken.
class UdpWorldServer {
 public:
  struct Settings {
    Endpoint bind{};
    bool allow_unauthenticated{false};
    ThimbleWorldEnd::Settings end{};  // impairment and pinned peer count for both protocols
  };
  // nullptr, nothing: that protocol is not spoken, and its datagrams are refused.
  struct Worlds {
    coupling::WorldCoupling* of_1999{nullptr};
    ThimbleWorldEnd::MakeHalf make_half{};
  };

  [[nodiscard]] static Result<std::unique_ptr<UdpWorldServer>> open(boost::asio::io_context& io,
                                                                    const Clock& clock,
                                                                    const Settings& settings,
                                                                    const Worlds& worlds);
  // Over any other network than the sockets of this machine.
  [[nodiscard]] static Result<std::unique_ptr<UdpWorldServer>> open(DatagramNetwork& network,
                                                                    const Clock& clock,
                                                                    const Settings& settings,
                                                                    const Worlds& worlds);
  ~UdpWorldServer();

  [[nodiscard]] Endpoint local() const;  // with the port that was given for 0
  // Of all that comes to the port.
  [[nodiscard]] LinkStatus status() const;
  // Of each session of our own.
  [[nodiscard]] std::vector<LinkStatus> sessions() const;

 private:
  class Impl;
  explicit UdpWorldServer(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace thimble::link
