#include "daemon/link/udp_arm_link.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "daemon/link/arm_mailbox.hpp"
#include "daemon/link/udp_network.hpp"

namespace thimble::link {
namespace {

constexpr Duration kFirstBackOff = std::chrono::milliseconds(10);
constexpr Duration kMaxBackOff = std::chrono::milliseconds(100);

Endpoint local_for(const Endpoint& peer) {
  Endpoint local;
  local.is_v6 = peer.is_v6;
  if (!peer.is_loopback()) return local;  // any interface: the routing table chooses
  local.address = peer.address;
  return local;
}

std::span<const std::byte> bytes_of(const ThesisRequest& request) { return request; }
std::span<const std::byte> bytes_of(const ThimbleDatagram& datagram) { return datagram.view(); }

}  // namespace

// What does not depend on the protocol.
class UdpArmLink::Impl {
 public:
  explicit Impl(rt::WakeSignal* wake) : mailbox_(wake) {}
  virtual ~Impl() = default;
  [[nodiscard]] virtual Result<void> start() = 0;
  virtual void step() = 0;
  [[nodiscard]] virtual LinkStatus status() const = 0;
  [[nodiscard]] ArmMailbox& mailbox() { return mailbox_; }

 protected:
  ArmMailbox mailbox_;
};

template <class End, class Datagram>
class UdpArmLink::ImplOf final : public UdpArmLink::Impl {
 public:
  ImplOf(DatagramNetwork& network, const Clock& clock, const Endpoint& peer, End end,
         rt::WakeSignal* wake)
      : Impl(wake), clock_(&clock), peer_(peer), end_(std::move(end)), port_(network.make_port()) {}

  Result<void> start() override {
    if (Result<void> opened = port_->open(local_for(peer_)); !opened) return opened;
    port_->start(
        {.on_datagram = [this](const Endpoint& from,
                               std::span<const std::byte> bytes) { on_datagram(from, bytes); },
         .on_receive_error = [this] { on_receive_error(); },
         .on_timer = [this] { step(); }});
    return {};
  }

  void step() override { step(clock_->now()); }

  [[nodiscard]] LinkStatus status() const override {
    LinkStatus status = end_.status();
    status.peer = to_string(peer_);
    if (status.last_error.empty()) status.last_error = port_->last_error();
    return status;
  }

 private:
  void step(MonotonicTime now) {
    coupling::HandSample sample;
    if (mailbox_.take(sample)) end_.offer(sample);
    deliver(now);
    send(now);
    mailbox_.publish(end_.quality());
    const std::optional<MonotonicTime> due = end_.next_due();
    if (due) port_->wake_after(now, std::max(*due, blocked_until_) - now);
  }

  void on_receive_error() {
    const MonotonicTime now = clock_->now();
    ++end_.counters().receive_errors;  // mostly: nobody listens at the peer
    back_off(now);
    step(now);
  }

  void on_datagram(const Endpoint& from, std::span<const std::byte> bytes) {
    const MonotonicTime now = clock_->now();
    if (!(from == peer_)) {
      ++end_.counters().received;
      return end_.counters().reject(RejectReason::WrongPeer);
    }
    back_off_ = kFirstBackOff;
    blocked_until_ = now;
    end_.on_datagram(bytes, now);
    step(now);
  }

  void deliver(MonotonicTime now) {
    for (coupling::ConstraintSet reply; end_.take_reply(now, reply);) mailbox_.deliver(reply);
  }

  void send(MonotonicTime now) {
    if (now < blocked_until_) return;  // the newest sample waits; older ones were replaced
    for (Datagram datagram; end_.poll(now, datagram);) {
      if (port_->send(peer_, bytes_of(datagram)) == DatagramPort::Outcome::Done) continue;
      ++end_.counters().send_errors;
      return back_off(now);
    }
  }

  void back_off(MonotonicTime now) {
    if (now < blocked_until_) return;  // one outage, told twice
    blocked_until_ = now + back_off_;
    back_off_ = std::min(2 * back_off_, kMaxBackOff);
  }

  const Clock* clock_;
  Endpoint peer_;
  End end_;
  MonotonicTime blocked_until_{};
  Duration back_off_{kFirstBackOff};
  std::unique_ptr<DatagramPort> port_;  // last: its handlers use the rest
};

Result<std::unique_ptr<UdpArmLink>> UdpArmLink::open(boost::asio::io_context& io,
                                                     const Clock& clock, const Settings& settings,
                                                     rt::WakeSignal* wake) {
  UdpNetwork network(io);
  return open(network, clock, settings, wake);
}

Result<std::unique_ptr<UdpArmLink>> UdpArmLink::open(DatagramNetwork& network, const Clock& clock,
                                                     const Settings& settings,
                                                     rt::WakeSignal* wake) {
  if (!settings.end.key) {
    const Result<void> allowed = may_link(settings.peer, settings.allow_unauthenticated);
    if (!allowed) return tl::unexpected(allowed.error());
  }
  std::unique_ptr<Impl> impl;
  if (settings.end.protocol == ArmEndSettings::Protocol::Thimble) {
    impl = std::make_unique<ImplOf<ThimbleArmEnd, ThimbleDatagram>>(
        network, clock, settings.peer, make_thimble_end(settings.end), wake);
  } else {
    impl = std::make_unique<ImplOf<ThesisArmEnd, ThesisRequest>>(
        network, clock, settings.peer, make_thesis_end(settings.end), wake);
  }
  if (Result<void> started = impl->start(); !started) return tl::unexpected(started.error());
  return std::unique_ptr<UdpArmLink>(new UdpArmLink(std::move(impl)));
}

UdpArmLink::UdpArmLink(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
UdpArmLink::~UdpArmLink() = default;

coupling::ArmLink& UdpArmLink::arm_end() noexcept { return impl_->mailbox(); }
void UdpArmLink::on_wake() { impl_->step(); }
LinkStatus UdpArmLink::status() const { return impl_->status(); }

}  // namespace thimble::link
