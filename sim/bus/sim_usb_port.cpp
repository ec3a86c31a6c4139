#include "sim/bus/sim_usb_port.hpp"

#include <algorithm>
#include <utility>

namespace thimble::sim {
namespace {

using bus::UsbOutcome;
using bus::UsbTransferKind;
using plugin::UsbHandshake;

}  // namespace

SimUsbPort::SimUsbPort(VirtualClock& clock, bus::DeviceAddress address,
                       std::unique_ptr<plugin::SimUsbModel> model)
    : SimPort(model->describe(), std::move(address), bus::BusKind::Usb),
      clock_(&clock),
      model_(std::move(model)) {
  clock.events().schedule_at(*this, clock.now() + kUsbRound);
}

void SimUsbPort::drop_host() noexcept {
  SimUsb* host = host_.host();
  if (host == nullptr) return;
  host->disconnect();
  host_.detach(*host);
}

Result<std::unique_ptr<bus::UsbDevice>> SimUsbPort::open_usb(const bus::UsbClaim& claim) {
  const Result<void> free = check_free(host_.is_taken());
  if (!free.has_value()) return tl::unexpected(free.error());
  const auto pipes = bus::resolve_claim(claim, info().endpoints);
  if (!pipes.has_value()) return tl::unexpected(pipes.error().in(info().address.text));
  auto host = std::make_unique<SimUsb>(*this, pipes.value());
  host_.attach(*host);
  return host;
}

void SimUsbPort::fire(MonotonicTime now) noexcept {
  ++round_;
  if (advance(*model_, now)) {
    host_.visit([&](SimUsb* host) {
      if (host != nullptr) serve(*host, now);
    });
  }
  clock_->events().schedule_at(*this, now + kUsbRound);
}

void SimUsbPort::serve(SimUsb& host, MonotonicTime now) noexcept {
  bytes_left_ = kUsbBytesPerRound;
  serve_kind(host, UsbTransferKind::Interrupt, now);
  serve_control(host);
  serve_kind(host, UsbTransferKind::Bulk, now);
}

void SimUsbPort::serve_control(SimUsb& host) noexcept {
  const bus::UsbControlRequest* request = host.take_control();
  if (request == nullptr) return;
  if (!take_budget(kUsbControlOverheadBytes + request->length)) return;
  bus::UsbControlReply reply;
  const plugin::UsbAnswer answer = model_->control(
      *request, {reply.data.data(), bus::asks_for_data(*request) ? request->length : 0U});
  if (answer.handshake == UsbHandshake::Nak) return;
  reply.size = bus::asks_for_data(*request) ? answer.size : request->length;
  if (answer.handshake == UsbHandshake::Stall) {
    reply = {.outcome = UsbOutcome::Stalled};
  } else if (reply.size > request->length) {
    reply = {.outcome = UsbOutcome::Babbled};
  }
  host.finish_control(reply);
}

void SimUsbPort::serve_kind(SimUsb& host, UsbTransferKind kind, MonotonicTime now) noexcept {
  std::array<bool, bus::kMaxUsbPipes> has_more_out{};
  for (std::size_t pipe = 0; pipe < host.pipe_count(); ++pipe) {
    if (host.info(pipe).kind != kind || !is_due(host.info(pipe))) continue;
    has_more_out[pipe] = send_packet(host, pipe) && host.is_queued_out(pipe);
  }
  bool has_moved = true;
  while (has_moved) {
    has_moved = false;
    for (std::size_t pipe = 0; pipe < host.pipe_count(); ++pipe) {
      const bus::UsbEndpointInfo& endpoint = host.info(pipe);
      if (endpoint.kind != kind || !is_due(endpoint)) continue;
      if (has_more_out[pipe]) has_more_out[pipe] = send_packet(host, pipe);
      if (has_more_out[pipe]) has_moved = true;
      if (bus::is_usb_in(endpoint.address) && fetch_packet(host, pipe, now)) has_moved = true;
    }
    // An interrupt pipe has one transaction when it is due.
    if (kind == UsbTransferKind::Interrupt) return;
  }
}

bool SimUsbPort::send_packet(SimUsb& host, std::size_t pipe) noexcept {
  const std::span<const std::uint8_t> packet = host.take_out(pipe);
  if (packet.empty() || !take_budget(kUsbPacketOverheadBytes + packet.size())) return false;
  const UsbHandshake handshake = model_->out_packet(host.info(pipe).address, packet);
  if (handshake == UsbHandshake::Nak) return false;
  const bool is_taken = handshake == UsbHandshake::Ack;
  host.finish_out(pipe, is_taken ? UsbOutcome::Done : UsbOutcome::Stalled,
                  is_taken ? packet.size() : 0);
  return is_taken;
}

bool SimUsbPort::fetch_packet(SimUsb& host, std::size_t pipe, MonotonicTime now) noexcept {
  const bus::UsbEndpointInfo& endpoint = host.info(pipe);
  // The bus cannot know how much will come, so there must be time for a whole packet.
  const std::size_t most = kUsbPacketOverheadBytes + endpoint.max_packet_bytes;
  if (bytes_left_ < most) return false;
  const std::span<std::uint8_t> room(buffer_.data(), endpoint.max_packet_bytes);
  const plugin::UsbAnswer answer = model_->in_packet(endpoint.address, room);
  if (answer.handshake == UsbHandshake::Nak) return false;
  const std::size_t size = std::min(answer.size, room.size());
  take_budget(kUsbPacketOverheadBytes + size);
  UsbOutcome outcome = answer.size > room.size() ? UsbOutcome::Babbled : UsbOutcome::Done;
  if (answer.handshake == UsbHandshake::Stall) outcome = UsbOutcome::Stalled;
  host.finish_in(pipe, outcome, room.first(size), now);
  // The halt has to be cleared first, which is a request to endpoint 0.
  return outcome != UsbOutcome::Stalled;
}

bool SimUsbPort::is_due(const bus::UsbEndpointInfo& endpoint) const noexcept {
  if (endpoint.kind == UsbTransferKind::Bulk) return true;
  const std::uint64_t interval = std::max<std::uint64_t>(endpoint.interval, 1);
  return round_ % kUsbRoundsPerFrame == 0 && round_ / kUsbRoundsPerFrame % interval == 0;
}

bool SimUsbPort::take_budget(std::size_t bytes) noexcept {
  if (bytes > bytes_left_) return false;
  bytes_left_ -= bytes;
  return true;
}

}  // namespace thimble::sim
