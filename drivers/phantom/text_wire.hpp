#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/base/time.hpp"

// The text protocol of the open controllers on a Teensy (USB serial, CDC-ACM): numbers only. Driver
// and simulator share this file and the models table, never a codec.
//
// Source of everything here unless said otherwise: forsslund/woodenhaptics,
// firmware/woody_teensy_mini/woody_teensy_mini.ino and its README (2026); forsslund/hfabapi at
// cf00e976, hfab_protocol.h and hfab_serial.cpp.
namespace thimble::phantom::text {

inline constexpr std::uint16_t kVendorId = 0x16c0;  // Teensy, USB serial: shared by the world
inline constexpr std::uint16_t kProductId = 0x0483;

// Host to device: "[ma,ma,ma]" and a newline, whole mA of the motors a, b, c. Behind the bracket
// the device bears newlines, returns and NULs only; hosts pad with NULs to this.
inline constexpr std::size_t kShortestMessageBytes = 16;
// A message that has already come when the device looks behind the bracket of the one before makes
// that one an error, and loses its own first byte: without its bracket it is an error, too. So ours
// begin with a byte that the device skips; then the newer of the two is taken.
inline constexpr char kToLose = ' ';
// What the device keeps of a message; without a bracket by then it starts anew.
inline constexpr std::size_t kBufferBytes = 127;

// Device to host, once for each message and never unasked: "[model,a,b,c,d,e,f,error]" and a
// newline. Counters of the motors are as wide as an int, zero at power-up and at every press of the
// calibration button; those of a gimbal 0 to 1023.
inline constexpr std::size_t kFieldCount = 8;
inline constexpr std::size_t kCounterCount = 6;

// Bits of `error`. The first three are a sensor of the gimbal each, and the rest of the report is
// good. The others: the message was not taken, and the counters are those of the last that was.
inline constexpr std::int32_t kErrorGimbal = 7;
inline constexpr std::int32_t kErrorTrailing = 8;
inline constexpr std::int32_t kErrorBufferFull = 128;
inline constexpr std::int32_t kErrorNoStart = 256;
inline constexpr std::int32_t kErrorFieldCount = 512;
inline constexpr std::int32_t kErrorParse = 1024;

// After this long without a message that it took, the device drops the enable line and sets neutral
// PWM; the next message enables again.
inline constexpr Duration kWatchdog = std::chrono::milliseconds(100);

// A current beyond the build's full scale is replaced by 0, and not by the full scale. Duty as that
// of the HID build (phantom_wire.hpp), at 4 kHz with 13 bits.
inline constexpr double kAmplifierMaxA = 6.0;
inline constexpr double kPwmHz = 4000;

// A build may want its button pressed before it is used. Until then its motors are held off, and it
// reports a made-up counter a, which goes slowly up and down about 8000, and the current that it
// was told for motor a as counter b.
inline constexpr double kFakedMiddle_counts = 8000;
inline constexpr double kFakedSwing_counts = 4000;
inline constexpr double kFakedStep_rad = 0.0002;  // of the sine, for each message

// What a controller says that it drives. 1 is a Polhem of 2022, whose linkage is not driven here.
struct Build {
  std::string_view model;  // of the models table
  std::int32_t number{0};
};
// premium-1.5: ours; the same builds of the firmware are for "vintage" arms of that maker.
inline constexpr std::array<Build, 3> kBuilds{
    {{"phantom-vintage", 2}, {"premium-1.5", 2}, {"woody-2015", 3}}};
[[nodiscard]] constexpr std::optional<std::int32_t> build_number(std::string_view model) noexcept {
  for (const Build& build : kBuilds) {
    if (build.model == model) return build.number;
  }
  return std::nullopt;
}

// What a simulated arm's name has behind the model's, to be told from that of the HID build.
inline constexpr std::string_view kSimSuffix = "-serial";

}  // namespace thimble::phantom::text
