#pragma once

#include <memory>
#include <vector>

#include "daemon/link/line_port.hpp"
#include "daemon/link/link_counters.hpp"
#include "daemon/link/serial_line.hpp"
#include "daemon/link/udp_world_server.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// The world's end of both protocols along a serial line: LineWorldEnd behind a port. Errors of the
// line end nothing: SerialArmLink.
//
// Thread: the one that the ports run on. RT: not. Ownership: ports, clock and worlds must outlive
// it. Errors: none.
class SerialWorldServer {
 public:
  struct Settings {
    SerialLine line{};
    ThimbleWorldEnd::Settings end{};
  };

  SerialWorldServer(LinePorts& ports, const Clock& clock, const Settings& settings,
                    const UdpWorldServer::Worlds& worlds);
  ~SerialWorldServer();

  // Of all that comes along the line.
  [[nodiscard]] LinkStatus status() const;
  // Of the session of our own, if there is one.
  [[nodiscard]] std::vector<LinkStatus> sessions() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace thimble::link
