#pragma once

#include <memory>

#include "daemon/coupling/arm_link.hpp"
#include "daemon/link/arm_end_settings.hpp"
#include "daemon/link/datagram_port.hpp"
#include "daemon/link/endpoint.hpp"
#include "daemon/link/link_counters.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/wake_signal.hpp"

namespace boost::asio {
class io_context;
}

namespace thimble::link {

// The arm's end of a protocol over UDP: ThesisArmEnd or ThimbleArmEnd behind a socket. Nothing that
// a network or a peer does ends it: errors are counted, and sending is tried again after a back-off
// of 10 … 100 ms; ours: a hundred samples of 1 kHz cost one send, and no person waits for 0.1 s.
// Datagrams of others than the peer are refused.
//
// Thread: arm_end() is for the servo; everything else for the thread that runs the network.
// RT: not, but for the arm end; one receive, one send a message, no allocation.
// Ownership: io_context or network, clock and wake signal must outlive it.
// Errors: open() when it may not link there (may_link(), without a key) or no socket can be had.
class UdpArmLink {
 public:
  struct Settings {
    Endpoint peer{};
    bool allow_unauthenticated{false};
    ArmEndSettings end{};
  };

  // Over the sockets of this machine, or over any other network: a port of it each.
  // `wake` is signalled by the servo; who waits for it calls on_wake(). None: the caller calls
  // on_wake() by itself.
  [[nodiscard]] static Result<std::unique_ptr<UdpArmLink>> open(boost::asio::io_context& io,
                                                                const Clock& clock,
                                                                const Settings& settings,
                                                                rt::WakeSignal* wake);
  [[nodiscard]] static Result<std::unique_ptr<UdpArmLink>> open(DatagramNetwork& network,
                                                                const Clock& clock,
                                                                const Settings& settings,
                                                                rt::WakeSignal* wake);
  ~UdpArmLink();

  [[nodiscard]] coupling::ArmLink& arm_end() noexcept;
  void on_wake();  // sends what the servo left
  [[nodiscard]] LinkStatus status() const;

 private:
  class Impl;
  template <class End, class Datagram>
  class ImplOf;
  explicit UdpArmLink(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace thimble::link
