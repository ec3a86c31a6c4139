#include "sim/export/usbip_bus.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <iterator>
#include <utility>

#include "hal/linux/timespec.hpp"
#include "sim/bus/sim_usb_port.hpp"

namespace thimble::sim {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

// Ours: what a connection may bring in one look.
constexpr int kMostReadsOfARound = 4;
// Ours: far beyond what a host leaves unread.
constexpr std::size_t kMostUnsentBytes = std::size_t{1} << 20;

bool is_for_later(const error_code& error) {
  return error == asio::error::would_block || error == asio::error::try_again;
}

unsigned rounds_for(const UsbPersona& persona) {
  const auto& endpoints = persona.info.endpoints;
  const bool has_bulk = std::any_of(endpoints.begin(), endpoints.end(), [](const auto& endpoint) {
    return endpoint.kind == bus::UsbTransferKind::Bulk;
  });
  return has_bulk ? kUsbRoundsPerFrame : 1;
}

void add(PlugCounters& sum, const PlugCounters& more) noexcept {
  sum.to_host += more.to_host;
  sum.from_host += more.from_host;
  sum.superseded += more.superseded;
  sum.lost += more.lost;
  sum.requests += more.requests;
  sum.malformed += more.malformed;
}

}  // namespace

UsbipBus::UsbipBus(plugin::SimUsbModel& model, UsbPersona persona,
                   const PlugSurroundings& surroundings)
    : model_(&model),
      persona_(std::move(persona)),
      around_(surroundings),
      rounds_per_frame_(rounds_for(persona_)) {
  around_.clock->events().schedule_at(*this, around_.clock->now() + round_period());
}

Duration UsbipBus::round_period() const noexcept { return kUsbFrame / rounds_per_frame_; }

Result<void> UsbipBus::plug() {
  if (is_plugged_) return fail(Errc::Busy, "it is plugged in already");
  if (Result<void> told = tell_host(); !told) return told;
  if (has_no_supply_) model_->power_cycle();
  is_plugged_ = true;
  return {};
}

Result<void> UsbipBus::unplug(Supply supply) {
  const bool has_news = is_plugged_ || (supply == Supply::Goes && !has_no_supply_);
  if (!has_news) return fail(Errc::NotFound, "it is not plugged in");
  while (!connections_.empty()) drop(connections_.begin());
  has_no_supply_ = supply == Supply::Goes;
  if (has_no_supply_) model_->power_cycle();
  is_plugged_ = false;
  return {};
}

bool UsbipBus::is_attached() const noexcept {
  return std::any_of(connections_.begin(), connections_.end(),
                     [](const Connection& connection) { return connection.session.is_attached(); });
}

bool UsbipBus::is_open() const noexcept {
  const MonotonicTime now = around_.clock->now();
  return std::any_of(connections_.begin(), connections_.end(),
                     [&](const Connection& connection) { return connection.session.is_used(now); });
}

PlugCounters UsbipBus::counters() const noexcept {
  PlugCounters sum = closed_;
  for (const Connection& connection : connections_) add(sum, connection.session.counters());
  return sum;
}

void UsbipBus::fire(MonotonicTime now) noexcept {
  ++round_;
  around_.clock->events().schedule_at(*this, now + round_period());
  if (now < left_out_until_) {
    for (Connection& connection : connections_) connection.session.leave_round_out();
    return;
  }
  model_->advance(now);
  for (auto connection = connections_.begin(); connection != connections_.end();) {
    const auto next = std::next(connection);
    if (!run_round(*connection, now)) drop(connection);
    connection = next;
  }
  if (round_ % rounds_per_frame_ != 0) return;
  end_frame(round_ / rounds_per_frame_);
  plugin::ArmBackend* arm = model_->arm_backend();
  if (arm != nullptr) around_.log->note_sample(around_.time(now), arm->truth());
}

bool UsbipBus::run_round(Connection& connection, MonotonicTime now) {
  UsbipSession& session = connection.session;
  receive(connection, now);
  // What a host said before it hung up is done still: it may be the last zero.
  if (session.is_attached() && connection.is_sound) {
    session.serve(now);
  } else {
    session.leave_round_out();
  }
  return send(connection, now) && connection.is_up && !is_idle(connection, now) &&
         !is_over(connection);
}

MonotonicTime UsbipBus::next_needed() const noexcept {
  const MonotonicTime now = around_.clock->now();
  const auto rounds_left = rounds_per_frame_ - round_ % rounds_per_frame_;
  MonotonicTime needed = now + rounds_left * round_period();
  for (const Connection& connection : connections_) {
    needed = std::min(needed, connection.session.next_needed(now));
  }
  return needed;
}

// What comes is read at once: to wait for what the device does not have yet is no reason for a
// round.
bool UsbipBus::wait_for_kernel(MonotonicTime until) noexcept {
  const MonotonicTime needed = next_needed();
  // Whoever talks without an end is heard until then, not beyond it.
  while (has_word_from_kernel(until)) {
    for (Connection& connection : connections_) {
      receive(connection, around_.clock->now());
      if (!connection.is_up) return true;
    }
    if (next_needed() < needed) return true;
    if (around_.machine->now() >= until) return false;
  }
  return false;
}

bool UsbipBus::has_word_from_kernel(MonotonicTime until) noexcept {
  std::array<pollfd, kMostConnections> sockets{};
  nfds_t count = 0;
  for (Connection& connection : connections_) {
    sockets[count++] = {connection.socket.native_handle(), POLLIN, 0};
  }
  const Duration left = std::max(until - around_.machine->now(), Duration(0));
  const timespec most = linux::to_timespec(left);
  return ::ppoll(sockets.data(), count, &most, nullptr) > 0;
}

bool UsbipBus::is_idle(const Connection& connection, MonotonicTime now) noexcept {
  const UsbipSession& session = connection.session;
  const bool is_host = session.is_attached() && session.counters().requests > 0;
  return !is_host && now - connection.answered_at > kPatience;
}

// With its answer on the way: who asks again and again would keep its place for ever.
bool UsbipBus::is_over(Connection& connection) noexcept {
  return connection.session.is_over() && connection.session.outbox().empty();
}

UsbipSession& UsbipBus::connect(Socket socket) {
  const MonotonicTime now = around_.clock->now();
  connections_.push_back(
      {std::move(socket), UsbipSession(*model_, persona_, rounds_per_frame_, around_), now, now});
  return connections_.back().session;
}

// In order of their coming: who asked is answered in the same round, and then has the device or
// goes.
bool UsbipBus::make_room() {
  if (connections_.size() < kMostConnections) return true;
  const auto silent =
      std::find_if(connections_.begin(), connections_.end(), [](Connection& connection) {
        return !connection.session.is_attached() && connection.session.outbox().empty();
      });
  if (silent == connections_.end()) return false;
  drop(silent);
  return true;
}

void UsbipBus::receive(Connection& connection, MonotonicTime now) {
  if (!connection.is_up) return;  // the next round drops it
  connection.session.set_available(is_plugged_ && !is_attached());
  const std::size_t unsent = connection.session.outbox().size();
  connection.is_up = read(connection);
  if (connection.session.outbox().size() > unsent) connection.answered_at = now;
}

// Who does not read the answers is not heard, and so can ask for no more.
bool UsbipBus::read(Connection& connection) {
  if (connection.session.outbox().size() > kMostUnsentBytes) return true;
  std::array<std::uint8_t, 16384> buffer;
  for (int i = 0; i < kMostReadsOfARound; ++i) {
    error_code error;
    const std::size_t size = connection.socket.read_some(asio::buffer(buffer), error);
    if (error) return is_for_later(error);
    connection.is_sound = connection.session.take(std::span(buffer).first(size));
    if (!connection.is_sound) return false;
    if (size < buffer.size()) return true;  // that was all
  }
  return true;
}

bool UsbipBus::send(Connection& connection, MonotonicTime now) {
  std::vector<std::uint8_t>& outbox = connection.session.outbox();
  while (connection.sent < outbox.size()) {
    error_code error;
    const auto unsent = asio::buffer(outbox) + connection.sent;
    const std::size_t size = connection.socket.write_some(unsent, error);
    connection.sent += size;
    if (size > 0) connection.taken_at = now;
    if (error) return is_for_later(error) && now - connection.taken_at <= kPatience;
  }
  outbox.clear();
  connection.sent = 0;
  connection.taken_at = now;
  return true;
}

void UsbipBus::drop(std::list<Connection>::iterator connection) {
  add(closed_, connection->session.counters());
  connections_.erase(connection);
}

}  // namespace thimble::sim
