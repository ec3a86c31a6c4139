#include "sim/model/falcon/falcon_firmware.hpp"

#include <algorithm>

namespace thimble::sim {
namespace {

// Of arms.md 1.6, read here anew and not from the driver's facts.
constexpr std::uint8_t kBegin = '<';
constexpr std::uint8_t kEnd = '>';
constexpr std::uint8_t kNibbleZero = 'A';
constexpr std::size_t kNumberBytes = 4;
constexpr std::size_t kFlags = 13;
constexpr std::size_t kUnknown = 14;
constexpr unsigned kHomingFlag = 0x01;
constexpr unsigned kLampFlags = 0x0e;
constexpr unsigned kHomedBit = 0x10;  // of encoder 1; the next two above it
constexpr int kLargestCommand_counts = 4095;

// The first of the four bytes is the lowest nibble.
int number_at(std::span<const std::uint8_t> bytes) noexcept {
  int value = 0;
  for (std::size_t i = kNumberBytes; i-- > 0;) value = 16 * value + (bytes[i] - kNibbleZero);
  return value < 0x8000 ? value : value - 0x10000;
}

void put_number(std::int64_t value, std::span<std::uint8_t> bytes) noexcept {
  auto rest = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < kNumberBytes; ++i) {
    bytes[i] = static_cast<std::uint8_t>(kNibbleZero + rest % 16);
    rest /= 16;
  }
}

bool is_turn(std::uint64_t count, std::uint64_t every) noexcept {
  return every > 0 && count % every == 0;
}

}  // namespace

void FalconFirmware::start(const CrankCounts& now) noexcept {
  const FalconFirmwareCounters counters = counters_;
  const FalconReplyFaults faults = faults_;
  const std::uint8_t buttons = buttons_;
  *this = FalconFirmware{};
  counters_ = counters;
  faults_ = faults;
  buttons_ = buttons;
  zero_ = now;
}

void FalconFirmware::pass_home(std::size_t crank) noexcept {
  if (!is_homing_ || is_homed_[crank]) return;
  is_homed_[crank] = true;
  zero_[crank] = 0;
}

std::span<const std::uint8_t> FalconFirmware::take(std::uint8_t byte,
                                                   const CrankCounts& now) noexcept {
  if (request_bytes_ == 0 && byte != kBegin) {
    ++counters_.stray_bytes;
    return {};
  }
  request_[request_bytes_++] = byte;
  if (request_bytes_ < kBytes) return {};
  if (!is_request()) {
    ++counters_.broken;
    seek_next_begin();
    return {};
  }
  request_bytes_ = 0;
  ++counters_.requests;
  handle();
  put_reply(now);
  return spoil_reply();
}

bool FalconFirmware::is_request() const noexcept {
  const auto is_nibble = [](std::uint8_t byte) {
    return byte >= kNibbleZero && byte < kNibbleZero + 16;
  };
  return request_[kBytes - 1] == kEnd && request_[kFlags] >= kNibbleZero &&
         std::all_of(request_.begin() + 1, request_.begin() + kFlags, is_nibble);
}

void FalconFirmware::seek_next_begin() noexcept {
  const auto next = std::find(request_.begin() + 1, request_.end(), kBegin);
  counters_.stray_bytes += static_cast<std::uint64_t>(next - request_.begin());
  request_bytes_ = static_cast<std::size_t>(request_.end() - next);
  std::copy(next, request_.end(), request_.begin());
}

void FalconFirmware::handle() noexcept {
  const std::span<const std::uint8_t> bytes(request_);
  bool asks_for_force = false;
  for (std::size_t motor = 0; motor < motors_.size(); ++motor) {
    const int command = number_at(bytes.subspan(1 + kNumberBytes * motor, kNumberBytes));
    motors_[motor] = std::clamp(command, -kLargestCommand_counts, kLargestCommand_counts);
    if (motors_[motor] != command) ++counters_.clamped;
    asks_for_force = asks_for_force || command != 0;
  }
  const bool knows_itself = is_homed_[0] && is_homed_[1] && is_homed_[2];
  if (asks_for_force && !knows_itself) ++counters_.forces_before_homed;
  const auto flags = static_cast<unsigned>(request_[kFlags] - kNibbleZero);
  if ((flags & ~(kHomingFlag | kLampFlags)) != 0) ++counters_.unknown_flags;
  is_homing_ = (flags & kHomingFlag) != 0;
  lamps_ = static_cast<std::uint8_t>((flags & kLampFlags) >> 1U);
}

void FalconFirmware::put_reply(const CrankCounts& now) noexcept {
  const std::span<std::uint8_t> reply = std::span(reply_).subspan(held_bytes_, kBytes);
  unsigned flags = buttons_;
  for (std::size_t crank = 0; crank < now.size(); ++crank) {
    put_number(now[crank] - zero_[crank], reply.subspan(1 + kNumberBytes * crank));
    if (is_homing_ && is_homed_[crank]) flags |= kHomedBit << crank;
  }
  reply[0] = kBegin;
  reply[kFlags] = static_cast<std::uint8_t>(kNibbleZero + flags);
  reply[kUnknown] = kNibbleZero;
  reply[kBytes - 1] = kEnd;
}

std::span<const std::uint8_t> FalconFirmware::spoil_reply() noexcept {
  std::size_t size = held_bytes_ + kBytes;
  const bool is_held = held_bytes_ == 0 && is_turn(counters_.requests, faults_.glue_every);
  if (is_turn(counters_.requests, faults_.short_every)) size -= 2;
  held_bytes_ = is_held ? size : 0;
  return is_held ? std::span<const std::uint8_t>() : std::span(reply_).first(size);
}

}  // namespace thimble::sim
