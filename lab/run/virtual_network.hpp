#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/link/datagram_port.hpp"
#include "daemon/link/endpoint.hpp"

namespace thimble::lab {

// Datagrams between sessions of one process, in virtual time: what is sent is heard in the next
// pass(), all of it and in order, for whatever delays and loses is the link's own impairment. What
// nobody listens for is refused, as a system on loopback does.
//
// Each session is on a host, which has one address beside 127.0.0.1: whoever listens at any address
// hears what is sent to that of its host, or, where nobody has the address, to its port.
//
// Thread: one. Ownership: outlives the ports of all hosts. Deterministic.
class VirtualNetwork {
 public:
  // By host; the ports do not count. Not empty.
  explicit VirtualNetwork(const std::vector<link::Endpoint>& addresses);
  ~VirtualNetwork();
  VirtualNetwork(const VirtualNetwork&) = delete;
  VirtualNetwork& operator=(const VirtualNetwork&) = delete;

  [[nodiscard]] link::DatagramNetwork& host(std::size_t i) noexcept;
  // Whatever waits, and what comes of it, kMostRounds at most; each timer that is due once.
  void pass(MonotonicTime now);
  // When pass() has something to do; nothing: when somebody sends.
  [[nodiscard]] std::optional<MonotonicTime> due() const;

  // Ours: two ends that answer each other at once for ever would hold the time.
  static constexpr int kMostRounds = 64;

 private:
  class Host;
  class Port;
  struct Datagram {
    Port* from;
    link::Endpoint sender;
    link::Endpoint to;
    std::vector<std::byte> bytes;
  };

  [[nodiscard]] Port* find(const link::Endpoint& to) const;
  void deliver(const Datagram& datagram);

  std::vector<std::unique_ptr<Host>> hosts_;
  std::vector<Port*> ports_;  // in the order of their making
  std::vector<Datagram> waiting_;
  std::uint16_t next_port_{49152};  // RFC 6335: the first dynamic one
};

}  // namespace thimble::lab
