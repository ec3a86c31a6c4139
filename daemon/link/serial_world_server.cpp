#include "daemon/link/serial_world_server.hpp"

#include <algorithm>
#include <optional>

#include "daemon/link/line_world_end.hpp"

namespace thimble::link {

class SerialWorldServer::Impl {
 public:
  Impl(LinePorts& ports, const Clock& clock, const Settings& settings,
       const UdpWorldServer::Worlds& worlds)
      : clock_(&clock),
        line_(settings.line),
        end_(settings.end, worlds.of_1999, worlds.make_half, system_random(),
             settings.line.bit_per_s),
        port_(ports.make_port(line_.node, line_.bit_per_s)) {
    port_->start({.on_bytes =
                      [this](std::span<const std::byte> bytes) {
                        end_.on_bytes(bytes, clock_->now());
                        step();
                      },
                  .on_timer = [this] { step(); }});
  }

  [[nodiscard]] LinkStatus status() const {
    LinkStatus status = end_.status();
    const bool has_program_of_1999 = !status.peer.empty();
    tell_of_line(line_, port_->last_error(), status);
    if (!has_program_of_1999) status.peer.clear();
    return status;
  }
  [[nodiscard]] std::vector<LinkStatus> sessions() const {
    std::vector<LinkStatus> sessions = end_.sessions();
    for (LinkStatus& session : sessions) session.peer = line_.name;
    return sessions;
  }

 private:
  void step() {
    const MonotonicTime now = clock_->now();
    const bool has_room = port_->has_room();
    if (SerialFrame frame; has_room && end_.poll(now, frame)) port_->send(frame);
    const std::optional<MonotonicTime> due = end_.next_due();
    const Duration least = has_room ? Duration::zero() : kLineAbsentWait;
    if (due) port_->wake_after(now, std::max(*due - now, least));
  }

  const Clock* clock_;
  SerialLine line_;
  LineWorldEnd end_;
  std::unique_ptr<LinePort> port_;  // last: its handlers use the rest
};

SerialWorldServer::SerialWorldServer(LinePorts& ports, const Clock& clock, const Settings& settings,
                                     const UdpWorldServer::Worlds& worlds)
    : impl_(std::make_unique<Impl>(ports, clock, settings, worlds)) {}
SerialWorldServer::~SerialWorldServer() = default;

LinkStatus SerialWorldServer::status() const { return impl_->status(); }
std::vector<LinkStatus> SerialWorldServer::sessions() const { return impl_->sessions(); }

}  // namespace thimble::link
