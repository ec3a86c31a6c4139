#include "drivers/falcon/falcon_codec.hpp"

#include <algorithm>

namespace thimble::falcon {
namespace {

constexpr unsigned kNibbleBits = 4;
constexpr unsigned kNibbleMask = 0xf;
constexpr unsigned kFlagsMask = 0x7f;

struct LightBit {
  bool Lights::*is_on;
  std::uint8_t bit;
};
// The one place to change should an arm shine otherwise: see falcon_wire.hpp.
constexpr std::array<LightBit, 3> kLightBits{{
    {&Lights::is_red, wire::kLedRed},
    {&Lights::is_green, wire::kLedGreen},
    {&Lights::is_blue, wire::kLedBlue},
}};

std::size_t first_byte(std::size_t number) noexcept {
  return wire::kFirstNumberByte + number * wire::kNibblesPerNumber;
}

std::int16_t load_number(const RunPacket& packet, std::size_t number) noexcept {
  unsigned bits = 0;
  for (std::size_t i = 0; i < wire::kNibblesPerNumber; ++i) {
    const unsigned nibble = packet[first_byte(number) + i] - unsigned{wire::kNibbleZero};
    bits |= nibble << (kNibbleBits * i);
  }
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(bits));
}

void store_number(RunPacket& packet, std::size_t number, std::int16_t value) noexcept {
  const unsigned bits = static_cast<std::uint16_t>(value);
  for (std::size_t i = 0; i < wire::kNibblesPerNumber; ++i) {
    const unsigned nibble = (bits >> (kNibbleBits * i)) & kNibbleMask;
    packet[first_byte(number) + i] = static_cast<std::uint8_t>(wire::kNibbleZero + nibble);
  }
}

// Whether a report can have this byte there.
bool may_stand_at(std::size_t place, std::uint8_t byte) noexcept {
  const unsigned above = byte - unsigned{wire::kNibbleZero};  // wraps below: too large
  if (place == 0) return byte == wire::kRunBegin;
  if (place < wire::kFlagsByte) return above <= kNibbleMask;
  if (place == wire::kFlagsByte) return above <= kFlagsMask;
  if (place == wire::kUnknownByte) return true;
  return byte == wire::kRunEnd;
}

RunReport parse(const RunPacket& packet) noexcept {
  RunReport report;
  for (std::size_t i = 0; i < 3; ++i) report.encoder_counts[i] = load_number(packet, i);
  const unsigned flags = packet[wire::kFlagsByte] - unsigned{wire::kNibbleZero};
  report.buttons = static_cast<std::uint8_t>(flags & wire::kButtons);
  report.homed = static_cast<std::uint8_t>(flags & wire::kAllHomed);
  return report;
}

}  // namespace

RunPacket encode_run_command(const RunCommand& command) noexcept {
  RunPacket packet{};
  packet.fill(wire::kNibbleZero);
  packet.front() = wire::kRunBegin;
  packet.back() = wire::kRunEnd;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto counts = static_cast<std::int16_t>(
        std::clamp<int>(command.motor_counts[i], -wire::kMaxMotor_counts, wire::kMaxMotor_counts));
    store_number(packet, i, counts);
  }
  unsigned flags = command.is_homing ? wire::kHomingOn : 0U;
  for (const LightBit& light : kLightBits) {
    if (command.lights.*light.is_on) flags |= light.bit;
  }
  packet[wire::kFlagsByte] = static_cast<std::uint8_t>(wire::kNibbleZero + flags);
  return packet;
}

std::span<const std::uint8_t> serial_bytes(std::span<const std::uint8_t> usb_packet) noexcept {
  if (usb_packet.size() <= wire::kModemStatusBytes) return {};
  return usb_packet.subspan(wire::kModemStatusBytes);
}

std::optional<RunReport> RunParser::take(std::uint8_t byte) noexcept {
  window_[size_++] = byte;
  if (!may_stand_at(size_ - 1, byte)) drop_to_next_begin();
  if (size_ < window_.size()) return std::nullopt;
  size_ = 0;
  return parse(window_);
}

// What is in the window cannot be a report: the next that may begin one is looked for behind it.
void RunParser::drop_to_next_begin() noexcept {
  const auto end = window_.begin() + static_cast<std::ptrdiff_t>(size_);
  auto begin = window_.begin() + 1;
  const auto fits = [&](RunPacket::iterator from) {
    for (auto at = from; at != end; ++at) {
      if (!may_stand_at(static_cast<std::size_t>(at - from), *at)) return false;
    }
    return true;
  };
  while (begin != end && !fits(begin)) ++begin;
  lost_bytes_ += static_cast<std::uint64_t>(begin - window_.begin());
  size_ = static_cast<std::size_t>(std::copy(begin, end, window_.begin()) - window_.begin());
}

}  // namespace thimble::falcon
