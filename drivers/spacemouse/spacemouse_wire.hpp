#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/base/time.hpp"

// What a 3Dconnexion puck says on the wire: numbers only. Driver and simulator share this file and
// the models table, never a codec.
//
// Source unless said otherwise: FreeSpacenav/spacenavd at bac572ae, src/dev.c; vrpn/vrpn at
// 893c7496, vrpn_3DConnexion.C (facts; section 3.9 of the facts sheet).
namespace thimble::spacemouse::wire {

// Reports are numbered; the number is the first byte. Axes are 16 bits, little-endian, signed:
// x to the right, y towards the person, z down (FreeSpacenav/spnavcfg issue 32: a puck that is
// pressed down is told as negative upwards), and turns about them.
inline constexpr std::uint8_t kTranslationReport = 1;  // all six axes in the combined layout
inline constexpr std::uint8_t kRotationReport = 2;     // separate layout only
inline constexpr std::uint8_t kButtonReport = 3;       // a bit for each, sparse on newer pucks
inline constexpr std::uint8_t kLightReport = 4;        // to the puck: a byte, 1 for on
// By which the layouts are told apart: the length of a report with its number.
inline constexpr std::size_t kSeparateBytes = 7;
inline constexpr std::size_t kCombinedBytes = 13;

// AndunHH/spacemouse, SpaceNavigator.md (watched with usbmon): a report every 8 ms while deflected,
// held still or not; back at rest zero is said three times, then nothing.
inline constexpr Duration kReportPeriod = std::chrono::milliseconds(8);
inline constexpr int kZeroReports = 3;

}  // namespace thimble::spacemouse::wire
