#include "lab/run/virtual_network.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "daemon/link/earliest.hpp"

namespace thimble::lab {
namespace {

using link::DatagramPort;
using link::Endpoint;

bool is_any(const Endpoint& endpoint) { return endpoint.address == std::array<std::uint8_t, 16>{}; }

}  // namespace

class VirtualNetwork::Host final : public link::DatagramNetwork {
 public:
  Host(VirtualNetwork& network, const Endpoint& address) : network_(&network), address_(address) {}
  [[nodiscard]] std::unique_ptr<DatagramPort> make_port() override;
  [[nodiscard]] VirtualNetwork& network() const noexcept { return *network_; }
  [[nodiscard]] const Endpoint& address() const noexcept { return address_; }

 private:
  VirtualNetwork* network_;
  Endpoint address_;
};

class VirtualNetwork::Port final : public DatagramPort {
 public:
  explicit Port(const Host& host) : host_(&host) { host.network().ports_.push_back(this); }
  ~Port() override {
    std::erase(host_->network().ports_, this);
    for (Datagram& datagram : host_->network().waiting_) {
      if (datagram.from == this) datagram.from = nullptr;
    }
  }

  [[nodiscard]] Result<void> open(const Endpoint& bind) override {
    VirtualNetwork& network = host_->network();
    for (const Port* other : network.ports_) {
      if (bind.port == 0 || other->local_ != bind || !other->is_open_) continue;
      if (is_any(bind) && other->host_ != host_) continue;
      return fail(Errc::Busy, "another session already listens on " + to_string(bind));
    }
    local_ = bind;
    if (bind.port == 0) local_.port = network.next_port_++;
    is_open_ = true;
    return {};
  }
  [[nodiscard]] Endpoint local() const override { return local_; }
  void start(Handlers handlers) override { handlers_ = std::move(handlers); }
  [[nodiscard]] Outcome send(const Endpoint& to, std::span<const std::byte> bytes) override {
    Endpoint sender = local_;
    if (is_any(local_) && !to.is_loopback()) {
      sender = host_->address();
      sender.port = local_.port;
    } else if (is_any(local_)) {
      sender = to;
      sender.port = local_.port;
    }
    host_->network().waiting_.push_back({this, sender, to, {bytes.begin(), bytes.end()}});
    return Outcome::Done;
  }
  void wake_after(MonotonicTime now, Duration wait) override {
    link::take_earlier(wakes_at_, now + wait);
  }
  [[nodiscard]] const std::string& last_error() const noexcept override { return last_error_; }

  [[nodiscard]] std::optional<MonotonicTime> wakes_at() const noexcept { return wakes_at_; }
  void fire() {
    wakes_at_.reset();
    handlers_.on_timer();
  }
  void hear(const Endpoint& from, std::span<const std::byte> bytes) {
    handlers_.on_datagram(from, bytes.first(std::min(bytes.size(), kMaxDatagram + 1)));
  }
  void refuse() {
    last_error_ = "receive: nobody listens there";
    handlers_.on_receive_error();
  }
  // 2: it has that address; 1: any, on that host; 0: any, on a host of another address.
  [[nodiscard]] std::optional<int> nearness_to(const Endpoint& to) const {
    if (!is_open_ || local_.port != to.port) return std::nullopt;
    if (local_.has_same_address(to)) return 2;
    if (!is_any(local_)) return std::nullopt;
    return host_->address().has_same_address(to) ? 1 : 0;
  }

 private:
  const Host* host_;
  Endpoint local_{};
  bool is_open_{false};
  Handlers handlers_{};
  std::optional<MonotonicTime> wakes_at_;
  std::string last_error_;
};

std::unique_ptr<DatagramPort> VirtualNetwork::Host::make_port() {
  return std::make_unique<Port>(*this);
}

VirtualNetwork::VirtualNetwork(const std::vector<Endpoint>& addresses) {
  for (const Endpoint& address : addresses) {
    hosts_.push_back(std::make_unique<Host>(*this, address));
  }
}

VirtualNetwork::~VirtualNetwork() = default;

link::DatagramNetwork& VirtualNetwork::host(std::size_t i) noexcept { return *hosts_[i]; }

VirtualNetwork::Port* VirtualNetwork::find(const Endpoint& to) const {
  Port* nearest = nullptr;
  int nearness = -1;
  for (Port* port : ports_) {
    const std::optional<int> of_port = port->nearness_to(to);
    if (!of_port || *of_port <= nearness) continue;
    nearest = port;
    nearness = *of_port;
  }
  return nearest;
}

void VirtualNetwork::deliver(const Datagram& datagram) {
  if (Port* const port = find(datagram.to)) return port->hear(datagram.sender, datagram.bytes);
  if (datagram.from != nullptr) datagram.from->refuse();
}

void VirtualNetwork::pass(MonotonicTime now) {
  const std::vector<Port*> ports = ports_;
  for (Port* port : ports) {
    if (port->wakes_at() && *port->wakes_at() <= now) port->fire();
  }
  for (int round = 0; round < kMostRounds && !waiting_.empty(); ++round) {
    const std::vector<Datagram> heard = std::exchange(waiting_, {});
    for (const Datagram& datagram : heard) deliver(datagram);
  }
}

std::optional<MonotonicTime> VirtualNetwork::due() const {
  std::optional<MonotonicTime> earliest;
  for (const Port* port : ports_) {
    link::take_earlier(earliest, port->wakes_at());
  }
  return earliest;
}

}  // namespace thimble::lab
