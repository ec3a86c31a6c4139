#include "sim/model/falcon/serial_line.hpp"

namespace thimble::sim {
namespace {

// Level of the line, `bits` bit times of the sender after the start bit began; idle is high.
bool level_at(std::uint8_t value, double bits) noexcept {
  if (bits < 1) return false;
  if (bits >= 9) return true;
  const auto index = static_cast<unsigned>(bits) - 1U;
  return (static_cast<unsigned>(value) >> index & 1U) != 0;
}

}  // namespace

ReceivedByte receive_at(SerialByte sent, double speed_baud) noexcept {
  if (!(sent.speed_baud > 0) || !(speed_baud > 0)) return {0, false};
  const double bits_per_bit = sent.speed_baud / speed_baud;
  unsigned value = 0;
  for (unsigned bit = 0; bit < 8; ++bit) {
    if (level_at(sent.value, (1.5 + bit) * bits_per_bit)) value |= 1U << bit;
  }
  return {static_cast<std::uint8_t>(value), level_at(sent.value, 9.5 * bits_per_bit)};
}

Duration serial_byte_time(double speed_baud) noexcept {
  return from_seconds(kSerialBitsPerByte / speed_baud);
}

}  // namespace thimble::sim
