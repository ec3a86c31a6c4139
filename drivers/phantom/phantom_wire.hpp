#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/base/time.hpp"

// The HID protocol of the open WoodenHaptics-family controller: numbers only. Driver and
// simulator share this file and the models table, never a codec.
//
// Source of everything here unless said otherwise: forsslund/haptikfabrikenapi at b8d6c944,
// firmware/main.cpp and src/fsusbhapticdevicethread.{h,cpp}; 49-teensy.rules for the ids.
namespace thimble::phantom::wire {

// Ids. Both pairs are defaults of a tool kit and shared by the world.
inline constexpr std::uint16_t kMbedVendorId = 0x1234;  // mbed USBHID default, LPC1768
inline constexpr std::uint16_t kMbedProductId = 0x0006;
inline constexpr std::uint16_t kTeensyVendorId = 0x16c0;  // Teensy RawHID
inline constexpr std::uint16_t kTeensyProductId = 0x0486;

// Reports carry no report id. Both forms begin with seven packed little-endian int16; the
// Teensy form pads to 64 bytes.
inline constexpr std::size_t kMbedReportBytes = 14;
inline constexpr std::size_t kTeensyReportBytes = 64;
inline constexpr std::size_t kFieldCount = 7;

// The most that the field of a current (int16, mA) can say; so no firmware build has a full scale
// beyond it.
inline constexpr double kLargestCurrentA = 32.767;

// Device to host, index of the int16.
inline constexpr std::size_t kEncoderA = 0;  // b and c follow: base encoders, incremental,
                                             // 16 bit with wrap, zero at power-up
inline constexpr std::size_t kEncoderD = 3;  // e and f follow: gimbal
inline constexpr std::size_t kInfo = 6;
inline constexpr std::uint16_t kInfoCalibrationPressed = 1;  // bit: pressed since the last set

// Host to device, index of the int16.
inline constexpr std::size_t kCurrentA = 0;  // b and c follow: mA; counters d..f for a set
inline constexpr std::size_t kCommand = 3;
inline constexpr std::size_t kAttribute0 = 4;  // 1 and 2 follow: counters a..c for a set
inline constexpr std::int16_t kCommandCurrents = 0;
inline constexpr std::int16_t kCommandSetCounters = 1;  // also clears kInfoCalibrationPressed

// Teensy and Polhem firmwares (64-byte form) fold the stylus button into encoder d: a value
// above the threshold means pressed, and the fold must be subtracted to get the count. The
// mbed firmware (14-byte form) does not fold: it has no stylus button.
inline constexpr std::int16_t kButtonThreshold = 5000;
inline constexpr std::int16_t kButtonFold = 10000;

// Exchange, in lock-step: the device sends one report, then waits for one of the host and
// drains to the newest.
// After this long without a report the device disables the motor drivers and sets neutral
// PWM; the next report enables them again.
inline constexpr Duration kWatchdog = std::chrono::milliseconds(500);
// Interrupt endpoint of a full-speed device, the fastest the exchange can go.
inline constexpr Duration kSamplePeriod = std::chrono::milliseconds(1);

// Motor current to PWM duty: 0.5 + 0.4 * I / Imax at 2 kHz, Imax of the firmware build, which
// the host cannot ask for.
inline constexpr double kPwmNeutral = 0.5;
inline constexpr double kPwmSpan = 0.4;
inline constexpr double kPwmHz = 2000;
inline constexpr double kAmplifierSmallA = 3.0;
inline constexpr double kAmplifierLargeA = 6.0;

}  // namespace thimble::phantom::wire
