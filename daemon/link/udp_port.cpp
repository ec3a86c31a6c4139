#include "daemon/link/udp_port.hpp"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <utility>

namespace thimble::link {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

constexpr int kInteractivePriority = 6;  // socket(7): the highest that needs no privilege

udp::endpoint to_asio(const Endpoint& endpoint) {
  if (endpoint.is_v6) {
    return {asio::ip::address_v6(endpoint.address, endpoint.scope), endpoint.port};
  }
  asio::ip::address_v4::bytes_type bytes{};
  std::copy_n(endpoint.address.begin(), bytes.size(), bytes.begin());
  return {asio::ip::address_v4(bytes), endpoint.port};
}

Endpoint from_asio(const udp::endpoint& endpoint) {
  Endpoint out;
  out.port = endpoint.port();
  out.is_v6 = endpoint.address().is_v6();
  if (out.is_v6) {
    out.address = endpoint.address().to_v6().to_bytes();
    out.scope = static_cast<std::uint32_t>(endpoint.address().to_v6().scope_id());
    return out;
  }
  const auto bytes = endpoint.address().to_v4().to_bytes();
  std::copy(bytes.begin(), bytes.end(), out.address.begin());
  return out;
}

void set_int(int socket, int level, int name, int value) {
  // Both options only tune: without them datagrams still travel.
  static_cast<void>(::setsockopt(socket, level, name, &value, sizeof value));
}

// Reports of refused datagrams pile up beside the data and keep the socket "readable".
void drain_error_queue(int socket) {
  std::array<std::byte, 64> ignored{};
  for (int i = 0; i < 64; ++i) {
    if (::recv(socket, ignored.data(), ignored.size(), MSG_ERRQUEUE | MSG_DONTWAIT) < 0) return;
  }
}

}  // namespace

UdpPort::UdpPort(asio::io_context& io)
    : socket_(io), timer_(io), alive_(std::make_shared<Alive>()) {}

UdpPort::~UdpPort() = default;

Result<void> UdpPort::open(const Endpoint& bind) {
  error_code error;
  const udp::endpoint local = to_asio(bind);
  socket_.open(local.protocol(), error);
  if (!error) socket_.non_blocking(true, error);
  // Whatever the machine's default is: [::] hears both families (ipv6(7), IPV6_V6ONLY).
  if (!error && bind.is_v6) socket_.set_option(asio::ip::v6_only(false), error);
  if (!error) socket_.bind(local, error);
  if (error == asio::error::address_in_use) {
    return fail(Errc::Busy, "another program already listens on " + to_string(bind));
  }
  if (error) return fail(Errc::System, "cannot bind " + to_string(bind) + ": " + error.message());
  const int native = socket_.native_handle();
  // No program that the daemon starts keeps the port (Asio 1.81 opens without SOCK_CLOEXEC).
  ::fcntl(native, F_SETFD, FD_CLOEXEC);
  set_int(native, SOL_SOCKET, SO_PRIORITY, kInteractivePriority);
  // Without it an unconnected socket never learns that nobody listens at the peer.
  set_int(native, bind.is_v6 ? IPPROTO_IPV6 : IPPROTO_IP, bind.is_v6 ? IPV6_RECVERR : IP_RECVERR,
          1);
  return {};
}

Endpoint UdpPort::local() const {
  error_code error;
  return from_asio(socket_.local_endpoint(error));
}

void UdpPort::start(Handlers handlers) {
  timer_.start(handlers.on_timer);
  alive_->handlers = std::move(handlers);
  receive_next();
}

// Asio keeps the socket in its epoll set for receives, whereas a wait enters it anew each time:
// decision 0098.
void UdpPort::receive_next() {
  socket_.async_receive_from(
      asio::buffer(buffer_), sender_,
      [this, alive = std::weak_ptr<Alive>(alive_)](const error_code& error, std::size_t size) {
        const std::shared_ptr<Alive> held = alive.lock();
        if (!held || error == asio::error::operation_aborted) return;
        if (error) {
          note_error("receive", error);
          held->handlers.on_receive_error();
        } else {
          held->handlers.on_datagram(from_asio(sender_), std::span(buffer_).first(size));
        }
        if (held.use_count() > 1) receive_next();
      });
}

UdpPort::Outcome UdpPort::send(const Endpoint& to, std::span<const std::byte> bytes) {
  error_code error;
  socket_.send_to(asio::buffer(bytes.data(), bytes.size()), to_asio(to), 0, error);
  if (!error) return Outcome::Done;
  if (error == asio::error::would_block || error == asio::error::no_buffer_space) {
    return Outcome::Blocked;
  }
  note_error("send", error);
  return Outcome::Failed;
}

void UdpPort::wake_after(MonotonicTime now, Duration wait) { timer_.wake_after(now, wait); }

void UdpPort::note_error(const char* what, const error_code& error) {
  last_error_ = std::string(what) + ": " + error.message();
  drain_error_queue(socket_.native_handle());
}

}  // namespace thimble::link
