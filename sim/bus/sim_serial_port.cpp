#include "sim/bus/sim_serial_port.hpp"

#include <algorithm>
#include <utility>

#include "sim/bus/sim_usb_port.hpp"

namespace thimble::sim {
namespace {

// USB 2.0, 5.8.3: a bulk packet at full speed.
constexpr std::size_t kPacketBytes = 64;
constexpr std::int64_t kNanobitsPerByte = 10'000'000'000;  // start, 8 bits, stop

}  // namespace

// What was not used is gone, but for the part of a byte.
void SimSerialPort::Credit::earn(std::uint32_t bit_per_s) noexcept {
  nanobits_ = std::min(nanobits_, kNanobitsPerByte) + bit_per_s * kUsbRound.count();
}
std::size_t SimSerialPort::Credit::bytes() const noexcept {
  return static_cast<std::size_t>(nanobits_ / kNanobitsPerByte);
}
void SimSerialPort::Credit::spend(std::size_t bytes) noexcept {
  nanobits_ -= static_cast<std::int64_t>(bytes) * kNanobitsPerByte;
}

SimSerialPort::SimSerialPort(VirtualClock& clock, bus::DeviceAddress address,
                             std::unique_ptr<plugin::SimSerialModel> model)
    : SimPort(model->describe(), std::move(address), bus::BusKind::Serial),
      clock_(&clock),
      model_(std::move(model)),
      bit_per_s_(model_->bit_per_s()) {
  clock.events().schedule_at(*this, clock.now() + kUsbRound);
}

void SimSerialPort::drop_host() noexcept {
  SimSerial* host = host_.host();
  if (host == nullptr) return;
  host->disconnect();
  host_.detach(*host);
}

Result<std::unique_ptr<bus::SerialPort>> SimSerialPort::open_serial(const bus::SerialLine& line) {
  const Result<void> free = check_free(host_.is_taken());
  if (!free.has_value()) return tl::unexpected(free.error());
  if (line.bit_per_s == 0) {
    return fail(Errc::InvalidArgument, info().address.text + ": a line of 0 bit/s");
  }
  is_in_tune_.store(bit_per_s_ == 0 || line.bit_per_s == bit_per_s_);
  auto host = std::make_unique<SimSerial>(*this);
  host_.attach(*host);
  return host;
}

void SimSerialPort::fire(MonotonicTime now) noexcept {
  if (advance(*model_, now)) {
    host_.visit([&](SimSerial* host) {
      if (host != nullptr && is_in_tune_.load()) serve(*host, now);
    });
  }
  clock_->events().schedule_at(*this, now + kUsbRound);
}

void SimSerialPort::serve(SimSerial& host, MonotonicTime now) noexcept {
  if (bit_per_s_ == 0) {
    serve_packets(host, now);
  } else {
    serve_line(host, now);
  }
}

void SimSerialPort::serve_packets(SimSerial& host, MonotonicTime now) noexcept {
  std::size_t bytes_left = kUsbBytesPerRound;
  const std::size_t sent = send(host, kPacketBytes);
  if (sent > 0) bytes_left -= kUsbPacketOverheadBytes + sent;
  // The bus cannot know how much will come, so there must be time for a whole packet.
  while (bytes_left >= kUsbPacketOverheadBytes + kPacketBytes) {
    const std::size_t fetched = fetch(host, kPacketBytes, now);
    if (fetched == 0) return;
    bytes_left -= kUsbPacketOverheadBytes + fetched;
  }
}

void SimSerialPort::serve_line(SimSerial& host, MonotonicTime now) noexcept {
  out_credit_.earn(bit_per_s_);
  in_credit_.earn(bit_per_s_);
  out_credit_.spend(send(host, out_credit_.bytes()));
  in_credit_.spend(fetch(host, in_credit_.bytes(), now));
}

std::size_t SimSerialPort::send(SimSerial& host, std::size_t room) noexcept {
  std::span<const std::uint8_t> message = host.take_out();
  message = message.first(std::min(message.size(), room));
  if (message.empty()) return 0;
  const std::size_t taken = std::min(model_->take(message), message.size());
  host.sent_out(taken);
  return taken;
}

std::size_t SimSerialPort::fetch(SimSerial& host, std::size_t room, MonotonicTime now) noexcept {
  const std::span<std::uint8_t> out(buffer_.data(), std::min(room, buffer_.size()));
  if (out.empty()) return 0;
  const std::size_t size = std::min(model_->give(out), out.size());
  host.deliver(out.first(size), now);
  return size;
}

}  // namespace thimble::sim
