#include "daemon/link/udp_world_server.hpp"

#include <algorithm>
#include <utility>

#include "daemon/link/earliest.hpp"
#include "daemon/link/thesis_world_end.hpp"
#include "daemon/link/udp_network.hpp"

namespace thimble::link {
namespace {

constexpr Duration kRetrySend = std::chrono::milliseconds(1);

}  // namespace

class UdpWorldServer::Impl {
 public:
  Impl(DatagramNetwork& network, const Clock& clock, const Settings& settings, const Worlds& worlds)
      : clock_(&clock), port_(network.make_port()) {
    const ThimbleWorldEnd::Settings& end = settings.end;
    const bool may_be_open =
        may_listen(settings.bind, settings.allow_unauthenticated, end.pinned_peer).has_value();
    const bool is_pinned = settings.allow_unauthenticated && end.pinned_peer.has_value();
    if (worlds.of_1999 != nullptr && (end.key ? is_pinned : may_be_open)) {
      thesis_.emplace(ThesisWorldEnd::Settings{end.impairment, end.pinned_peer}, *worlds.of_1999);
    }
    if (!worlds.make_half || (!end.key && !may_be_open)) return;
    thimble_.emplace(end, worlds.make_half, system_random());
  }

  Result<void> start(const Endpoint& bind) {
    if (Result<void> opened = port_->open(bind); !opened) return opened;
    port_->start(
        {.on_datagram = [this](const Endpoint& from,
                               std::span<const std::byte> bytes) { on_datagram(from, bytes); },
         .on_receive_error = [this] { ++counters_.receive_errors; },
         .on_timer = [this] { step(clock_->now()); }});
    return {};
  }

  [[nodiscard]] Endpoint local() const { return port_->local(); }

  [[nodiscard]] LinkStatus status() const {
    LinkStatus status = thesis_ ? thesis_->status() : LinkStatus();
    status.counters = sum(status.counters, counters_);
    if (thimble_) {
      status.counters = sum(status.counters, thimble_->total());
      status.is_up = status.is_up || !thimble_->sessions().empty();
    }
    if (status.last_error.empty()) status.last_error = port_->last_error();
    if (status.last_error.empty() && thimble_) status.last_error = thimble_->refusal();
    return status;
  }

  [[nodiscard]] std::vector<LinkStatus> sessions() const {
    return thimble_ ? thimble_->sessions() : std::vector<LinkStatus>();
  }

 private:
  void on_datagram(const Endpoint& from, std::span<const std::byte> bytes) {
    const MonotonicTime now = clock_->now();
    if (is_thimble_datagram(bytes) && thimble_) {
      thimble_->on_datagram(from, bytes, now);
    } else if (thesis_) {
      thesis_->on_datagram(from, bytes, now);
    } else {
      ++counters_.received;
      counters_.reject(RejectReason::WrongVersion);
    }
    step(now);
  }

  void step(MonotonicTime now) {
    const bool has_room = send(now);
    if (!has_room) return port_->wake_after(now, kRetrySend);
    std::optional<MonotonicTime> due;
    if (thesis_) take_earlier(due, thesis_->next_due());
    if (thimble_) take_earlier(due, thimble_->next_due());
    if (due) port_->wake_after(now, std::max(*due - now, Duration::zero()));
  }

  // False when the socket has no room: the reply in hand goes first next time.
  bool send(MonotonicTime now) {
    while (has_unsent_ || take_reply(now)) {
      const DatagramPort::Outcome outcome = port_->send(unsent_.to, unsent_.datagram.view());
      has_unsent_ = outcome == DatagramPort::Outcome::Blocked;
      if (outcome != DatagramPort::Outcome::Done) ++counters_.send_errors;
      if (has_unsent_) return false;
    }
    return true;
  }

  // The next of either, in `unsent_`.
  bool take_reply(MonotonicTime now) {
    if (ThesisWorldEnd::Reply reply; thesis_ && thesis_->poll(now, reply)) {
      unsent_.to = reply.to;
      std::copy(reply.bytes.begin(), reply.bytes.end(), unsent_.datagram.bytes.begin());
      unsent_.datagram.size = reply.bytes.size();
      return true;
    }
    return thimble_ && thimble_->poll(now, unsent_);
  }

  const Clock* clock_;
  std::optional<ThesisWorldEnd> thesis_;
  std::optional<ThimbleWorldEnd> thimble_;
  LinkCounters counters_{};  // of the socket, and of what nobody here understands
  ThimbleWorldEnd::Reply unsent_{};
  bool has_unsent_{false};
  std::unique_ptr<DatagramPort> port_;  // last: its handlers use the rest
};

Result<std::unique_ptr<UdpWorldServer>> UdpWorldServer::open(boost::asio::io_context& io,
                                                             const Clock& clock,
                                                             const Settings& settings,
                                                             const Worlds& worlds) {
  UdpNetwork network(io);
  return open(network, clock, settings, worlds);
}

Result<std::unique_ptr<UdpWorldServer>> UdpWorldServer::open(DatagramNetwork& network,
                                                             const Clock& clock,
                                                             const Settings& settings,
                                                             const Worlds& worlds) {
  if (!settings.end.key) {
    const Result<void> allowed =
        may_listen(settings.bind, settings.allow_unauthenticated, settings.end.pinned_peer);
    if (!allowed) return tl::unexpected(allowed.error());
  }
  auto impl = std::make_unique<Impl>(network, clock, settings, worlds);
  if (Result<void> started = impl->start(settings.bind); !started) {
    return tl::unexpected(started.error());
  }
  return std::unique_ptr<UdpWorldServer>(new UdpWorldServer(std::move(impl)));
}

UdpWorldServer::UdpWorldServer(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
UdpWorldServer::~UdpWorldServer() = default;

Endpoint UdpWorldServer::local() const { return impl_->local(); }
LinkStatus UdpWorldServer::status() const { return impl_->status(); }
std::vector<LinkStatus> UdpWorldServer::sessions() const { return impl_->sessions(); }

}  // namespace thimble::link
