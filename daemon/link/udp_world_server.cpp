#include "daemon/link/udp_world_server.hpp"

#include <algorithm>
#include <utility>

#include "daemon/link/thesis_world_end.hpp"
#include "daemon/link/udp_port.hpp"

namespace thimble::link {
namespace {

constexpr Duration kRetrySend = std::chrono::milliseconds(1);

}  // namespace

class UdpWorldServer::Impl {
 public:
  Impl(boost::asio::io_context& io, const Clock& clock, const Settings& settings,
       coupling::WorldCoupling& world)
      : clock_(&clock),
        end_({.impairment = settings.impairment, .pinned_peer = settings.pinned_peer}, world),
        port_(io) {}

  Result<void> start(const Endpoint& bind) {
    if (Result<void> opened = port_.open(bind); !opened) return opened;
    port_.start(
        {.on_datagram = [this](const Endpoint& from,
                               std::span<const std::byte> bytes) { on_datagram(from, bytes); },
         .on_receive_error = [this] { ++end_.counters().receive_errors; },
         .on_timer = [this] { step(clock_->now()); }});
    return {};
  }

  [[nodiscard]] Endpoint local() const { return port_.local(); }

  [[nodiscard]] LinkStatus status() const {
    LinkStatus status = end_.status();
    if (status.last_error.empty()) status.last_error = port_.last_error();
    return status;
  }

 private:
  void on_datagram(const Endpoint& from, std::span<const std::byte> bytes) {
    const MonotonicTime now = clock_->now();
    end_.on_datagram(from, bytes, now);
    step(now);
  }

  void step(MonotonicTime now) {
    const bool has_room = send(now);
    if (!has_room) return port_.wake_after(now, kRetrySend);
    const std::optional<MonotonicTime> due = end_.next_due();
    if (due) port_.wake_after(now, std::max(*due - now, Duration::zero()));
  }

  // False when the socket has no room: the reply in hand goes first next time.
  bool send(MonotonicTime now) {
    while (has_unsent_ || end_.poll(now, unsent_)) {
      const UdpPort::Outcome outcome = port_.send(unsent_.to, unsent_.bytes);
      has_unsent_ = outcome == UdpPort::Outcome::Blocked;
      if (outcome != UdpPort::Outcome::Done) ++end_.counters().send_errors;
      if (has_unsent_) return false;
    }
    return true;
  }

  const Clock* clock_;
  ThesisWorldEnd end_;
  ThesisWorldEnd::Reply unsent_{};
  bool has_unsent_{false};
  UdpPort port_;  // last: its handlers use the rest
};

Result<std::unique_ptr<UdpWorldServer>> UdpWorldServer::open(boost::asio::io_context& io,
                                                             const Clock& clock,
                                                             const Settings& settings,
                                                             coupling::WorldCoupling& world) {
  const Result<void> allowed =
      may_listen(settings.bind, settings.allow_unauthenticated, settings.pinned_peer);
  if (!allowed) return tl::unexpected(allowed.error());
  auto impl = std::make_unique<Impl>(io, clock, settings, world);
  if (Result<void> started = impl->start(settings.bind); !started) {
    return tl::unexpected(started.error());
  }
  return std::unique_ptr<UdpWorldServer>(new UdpWorldServer(std::move(impl)));
}

UdpWorldServer::UdpWorldServer(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
UdpWorldServer::~UdpWorldServer() = default;

Endpoint UdpWorldServer::local() const { return impl_->local(); }
LinkStatus UdpWorldServer::status() const { return impl_->status(); }

}  // namespace thimble::link
