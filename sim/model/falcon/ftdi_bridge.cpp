#include "sim/model/falcon/ftdi_bridge.hpp"

#include <algorithm>

namespace thimble::sim {
namespace {

using plugin::UsbAnswer;
using plugin::UsbHandshake;

// Requests by number, ftdi_sio.h. Not the driver's facts: whether those are right is to show.
enum class Request : std::uint8_t {
  Reset = 0,
  ModemLines = 1,
  FlowControl = 2,
  BaudDivisor = 3,
  DataFormat = 4,
  GetModemStatus = 5,
  EventCharacter = 6,
  ErrorCharacter = 7,
  SetLatency = 9,
  GetLatency = 10,
};
constexpr std::uint8_t kVendorOut = 0x40;
constexpr std::uint8_t kVendorIn = 0xc0;

// Values of the reset request. That 1 is the host's side and 2 the line's: libftdi 1.5, whose
// older names said the opposite.
constexpr std::uint16_t kResetChip = 0;
constexpr std::uint16_t kPurgeFromHost = 1;
constexpr std::uint16_t kPurgeToHost = 2;

// Modem lines: levels in the low byte, which of them are meant in the high one.
constexpr unsigned kDtr = 0x01;
constexpr unsigned kRts = 0x02;

// The status, ftdi_sio.h: bit 0 of the first byte is always set.
constexpr std::uint8_t kAlwaysSet = 0x01;
constexpr unsigned kOverrun = 0x02;
constexpr unsigned kFramingError = 0x08;
constexpr unsigned kSenderEmpty = 0x60;  // holding register and shift register

}  // namespace

double ftdi_baud(std::uint32_t divisor) noexcept {
  constexpr std::array<double, 8> kEighths{0, 0.5, 0.25, 0.125, 0.375, 0.625, 0.75, 0.875};
  constexpr double kReference_hz = 3e6;
  divisor &= 0x1ffffU;
  if (divisor == 0) return 3e6;
  if (divisor == 1) return 2e6;
  const double whole = divisor & 0x3fffU;
  // Between 1 and 2 nothing is possible, says the sheet; what the chip then does it does not say.
  return kReference_hz / std::max(whole + kEighths[divisor >> 14U], 1.0);
}

void FtdiBridge::power_up(MonotonicTime t) noexcept {
  const FtdiCounters counters = counters_;
  const std::optional<Duration> insisted = insisted_;
  *this = FtdiBridge{};
  counters_ = counters;
  insisted_ = insisted;
  packet_due_at_ = t + latency();
}

UsbAnswer FtdiBridge::control(MonotonicTime t, const bus::UsbControlRequest& request,
                              std::span<std::uint8_t> in) noexcept {
  if (request.request_type == kVendorOut && set(t, request)) return {UsbHandshake::Ack, 0};
  const auto number = static_cast<Request>(request.request);
  if (request.request_type == kVendorIn && number == Request::GetLatency && !in.empty()) {
    in[0] = static_cast<std::uint8_t>(latency() / std::chrono::milliseconds(1));
    return {UsbHandshake::Ack, 1};
  }
  if (request.request_type == kVendorIn && number == Request::GetModemStatus) {
    const auto now = status();
    const std::size_t size = std::min(in.size(), now.size());
    std::copy_n(now.begin(), size, in.begin());
    return {UsbHandshake::Ack, size};
  }
  ++counters_.refused_requests;
  return {UsbHandshake::Stall, 0};
}

bool FtdiBridge::set(MonotonicTime t, const bus::UsbControlRequest& request) noexcept {
  switch (static_cast<Request>(request.request)) {
    case Request::Reset:
      reset(request.value);
      return true;
    case Request::ModemLines:
      set_modem_lines(request.value);
      return true;
    case Request::BaudDivisor:
      sender_.set_speed(ftdi_baud(request.value | (request.index & 1U) << 16U));
      return true;
    case Request::DataFormat:
      // Data bits in the low byte; parity, stop bits and break above: 8N1 is all zeros there.
      is_8n1_ = request.value == 8;
      return true;
    case Request::SetLatency:
      // A byte of milliseconds; what the chip makes of 0 nobody says, so it is the least: ours.
      latency_ = std::chrono::milliseconds(std::max(request.value & 0xff, 1));
      packet_due_at_ = t + latency();
      return true;
    case Request::FlowControl:
      if ((request.index >> 8U) != 0) ++counters_.unmodelled_requests;
      return true;
    case Request::EventCharacter:
    case Request::ErrorCharacter:
      ++counters_.unmodelled_requests;
      return true;
    default:
      return false;
  }
}

void FtdiBridge::reset(std::uint16_t what) noexcept {
  if (what == kResetChip || what == kPurgeFromHost) sender_.forget_waiting();
  if (what == kResetChip || what == kPurgeToHost) count_ = 0;
  if (what != kResetChip) return;
  // Speed and format stay as they are.
  is_dtr_high_ = false;
  is_rts_high_ = false;
}

void FtdiBridge::set_modem_lines(std::uint16_t value) noexcept {
  const unsigned levels = value & 0xffU;
  const unsigned meant = value >> 8U;
  if ((meant & kDtr) != 0) is_dtr_high_ = (levels & kDtr) != 0;
  if ((meant & kRts) != 0) is_rts_high_ = (levels & kRts) != 0;
}

UsbHandshake FtdiBridge::out_packet(MonotonicTime t, std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() > sender_.room()) {
    ++counters_.host_packets_nak;
    return UsbHandshake::Nak;
  }
  for (const std::uint8_t byte : bytes) sender_.push(t, byte);
  counters_.bytes_from_host += bytes.size();
  return UsbHandshake::Ack;
}

// In another format than the device's only that it is garbage is modelled.
SerialByte FtdiBridge::take_arrived() noexcept {
  SerialByte byte = sender_.take_arrived();
  if (!is_8n1_) byte.value = static_cast<std::uint8_t>(~byte.value);
  return byte;
}

void FtdiBridge::receive(SerialByte byte) noexcept {
  ReceivedByte received = receive_at(byte, speed_baud());
  if (!is_8n1_) received = {static_cast<std::uint8_t>(~received.value), false};
  if (!received.has_stop_bit) {
    ++counters_.framing_errors;
    has_framing_error_ = true;
  }
  if (count_ == to_host_.size()) {
    ++counters_.overruns;
    has_overrun_ = true;
    return;
  }
  to_host_[(first_ + count_) % to_host_.size()] = received.value;
  ++count_;
}

std::array<std::uint8_t, FtdiBridge::kStatusBytes> FtdiBridge::status() const noexcept {
  unsigned line = sender_.is_idle() ? kSenderEmpty : 0U;
  if (has_overrun_) line |= kOverrun;
  if (has_framing_error_) line |= kFramingError;
  return {kAlwaysSet, static_cast<std::uint8_t>(line)};
}

UsbAnswer FtdiBridge::in_packet(MonotonicTime t, std::span<std::uint8_t> out) noexcept {
  constexpr std::size_t kMostData = kPacketBytes - kStatusBytes;
  if (out.size() < kPacketBytes) return {};
  if (count_ < kMostData && t < packet_due_at_) return {};
  const auto head = status();
  std::copy(head.begin(), head.end(), out.begin());
  has_overrun_ = false;
  has_framing_error_ = false;
  const std::size_t size = std::min(count_, kMostData);
  for (std::size_t i = 0; i < size; ++i) {
    out[kStatusBytes + i] = to_host_[(first_ + i) % to_host_.size()];
  }
  first_ = (first_ + size) % to_host_.size();
  count_ -= size;
  counters_.bytes_to_host += size;
  ++(size > 0 ? counters_.data_packets : counters_.status_packets);
  packet_due_at_ = t + latency();
  return {UsbHandshake::Ack, kStatusBytes + size};
}

}  // namespace thimble::sim
