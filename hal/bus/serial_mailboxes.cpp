#include "hal/bus/serial_mailboxes.hpp"

#include <algorithm>

namespace thimble::bus {
namespace {

constexpr std::size_t kInPipe = 0;
constexpr std::size_t kOutPipe = 1;

}  // namespace

std::array<UsbOpenPipe, 2> serial_pipes() {
  const auto pipe = [](std::uint8_t endpoint, UsbDelivery delivery) {
    return UsbOpenPipe{{endpoint, delivery},
                       {.interface_number = 0,
                        .address = endpoint,
                        .kind = UsbTransferKind::Bulk,
                        .max_packet_bytes = kMaxSerialBytes,
                        .interval = 0}};
  };
  return {pipe(kSerialIn, UsbDelivery::Every), pipe(kSerialOut, UsbDelivery::Newest)};
}

SerialCounters serial_counters(const UsbCounters& in, const UsbCounters& out) noexcept {
  return {.chunks_in = in.packets_in,
          .chunks_skipped = in.packets_skipped,
          .messages_out = out.packets_out - out.writes_cut,
          .writes_superseded = out.writes_superseded,
          .writes_failed = out.failures + out.writes_cut};
}

SerialMailboxes::SerialMailboxes() : pipes_(serial_pipes()) {}

IoStatus SerialMailboxes::read(SerialChunk& out) noexcept {
  const IoStatus status = pipes_.read(kSerialIn, packet_);
  if (status != IoStatus::Ok) return status;
  out.size = packet_.size;
  std::copy_n(packet_.bytes.begin(), packet_.size, out.bytes.begin());
  out.arrived_at = packet_.arrived_at;
  out.sequence = packet_.sequence;
  return IoStatus::Ok;
}

IoStatus SerialMailboxes::submit(std::span<const std::uint8_t> message) noexcept {
  return pipes_.submit(kSerialOut, message);
}

SerialCounters SerialMailboxes::counters() const noexcept {
  SerialCounters counters =
      serial_counters(pipes_.counters(kSerialIn), pipes_.counters(kSerialOut));
  counters.bytes_in = bytes_in_.load(std::memory_order_relaxed);
  counters.bytes_out = bytes_out_.load(std::memory_order_relaxed);
  return counters;
}

void SerialMailboxes::deliver(std::span<const std::uint8_t> bytes, MonotonicTime at) noexcept {
  if (bytes.empty()) return;
  bytes_in_.fetch_add(bytes.size(), std::memory_order_relaxed);
  pipes_.finish_in(kInPipe, UsbOutcome::Done, bytes, at);
}

std::span<const std::uint8_t> SerialMailboxes::take_out() noexcept {
  if (out_.empty()) out_ = pipes_.take_out(kOutPipe);
  return out_.subspan(sent_);
}

bool SerialMailboxes::has_out() const noexcept { return !out_.empty() || pipes_.has_out(kOutPipe); }

void SerialMailboxes::sent_out(std::size_t bytes) noexcept {
  sent_ += std::min(bytes, out_.size() - sent_);
  if (out_.empty() || sent_ < out_.size()) return;
  bytes_out_.fetch_add(sent_, std::memory_order_relaxed);
  pipes_.finish_out(kOutPipe, UsbOutcome::Done, sent_);
  out_ = {};
  sent_ = 0;
}

}  // namespace thimble::bus
