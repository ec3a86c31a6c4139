#pragma once

#include <cstddef>
#include <cstdint>

// Facts of the invented arm: what its reports look like, and what is screwed together in it.
namespace gantry {

constexpr std::uint16_t kVendorId = 0xfff0;
constexpr std::uint16_t kProductId = 0x6a17;

// In, little-endian: counters of u, v, w as int32, then a byte of flags.
constexpr std::size_t kInputBytes = 13;
constexpr std::uint8_t kFlagReferenced = 1;
constexpr std::uint8_t kFlagStylusButton = 2;
constexpr std::uint8_t kFlagMotorsOn = 4;
// Out: currents of u, v, w as int16 in mA, a byte of command, a byte that is the sum of the others.
constexpr std::size_t kOutputBytes = 8;
constexpr std::uint8_t kCommandDrive = 1;
constexpr std::uint8_t kCommandForget = 2;  // the reference

constexpr int kAxes = 3;
constexpr double kPulley_m = 0.008;  // radius
constexpr double kCountsPerTurn = 4000;
constexpr double kTorque_newton_m_per_a = 0.02;
constexpr double kHalfTravel_m = 0.15;
constexpr double kPeakCurrent_a = 3;
constexpr double kContinuousCurrent_a = 1.5;
constexpr std::int64_t kFrame_ns = 1'000'000;
constexpr std::int64_t kWatchdog_ns = 50'000'000;

// Axis of the base frame along which u, v, w point, and which way.
constexpr int kBaseAxis[kAxes] = {0, 2, 1};
constexpr double kBaseSign[kAxes] = {1, -1, 1};

}  // namespace gantry
