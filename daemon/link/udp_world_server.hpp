#pragma once

#include <memory>
#include <optional>

#include "daemon/coupling/world_coupling.hpp"
#include "daemon/link/endpoint.hpp"
#include "daemon/link/impairment.hpp"
#include "daemon/link/link_counters.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace boost::asio {
class io_context;
}

namespace thimble::link {

// The world's end of the 1999 protocol over UDP (ThesisWorldEnd behind a socket). Every reply
// is sent, if need be when there is room again; errors are counted and end nothing.
//
// Thread: the one that runs the io_context. RT: not; one receive, one send a message, no
// allocation. Ownership: io_context, clock and world must outlive it.
// Errors: open() when it may not listen there (may_listen()) or the port is taken.
class UdpWorldServer {
 public:
  struct Settings {
    Endpoint bind{};
    bool allow_unauthenticated{false};
    std::optional<Endpoint> pinned_peer{};  // its port does not matter
    ImpairmentSettings impairment{};        // validated by the caller
  };

  [[nodiscard]] static Result<std::unique_ptr<UdpWorldServer>> open(boost::asio::io_context& io,
                                                                    const Clock& clock,
                                                                    const Settings& settings,
                                                                    coupling::WorldCoupling& world);
  ~UdpWorldServer();

  [[nodiscard]] Endpoint local() const;  // with the port that was given for 0
  [[nodiscard]] LinkStatus status() const;

 private:
  class Impl;
  explicit UdpWorldServer(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace thimble::link
