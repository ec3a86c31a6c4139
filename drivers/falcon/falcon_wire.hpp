#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hal/base/time.hpp"

// What a Novint Falcon says and is told on the wire: numbers only. Driver and simulator share this
// file and the models table, never a codec.
//
// Source of everything here unless said otherwise: libnifalcon/libnifalcon at f7c727aa,
// include/falcon/core/FalconComm.h, src/comm/FalconCommLibUSB.cpp, src/core/FalconFirmware.cpp,
// src/firmware/FalconFirmwareNovintSDK.cpp (facts; sections 1.2 to 1.10 of the facts sheet).
namespace thimble::falcon::wire {

// An FTDI FT232R bridge, full speed, before a TI TMS320 2811 processor. The vendor id is FTDI's,
// the product id is the Falcon's own.
inline constexpr std::uint16_t kVendorId = 0x0403;
inline constexpr std::uint16_t kProductId = 0xcb48;
inline constexpr std::uint8_t kInterface = 0;
inline constexpr std::uint8_t kBulkIn = 0x81;
inline constexpr std::uint8_t kBulkOut = 0x02;
inline constexpr std::size_t kUsbPacketBytes = 64;

// Every IN packet begins with the modem's status. One of nothing else carries no data, and is
// neither the end of a stream nor an unplugging. It comes when the latency timer runs out.
inline constexpr std::size_t kModemStatusBytes = 2;
inline constexpr std::size_t kMaxPayloadBytes = kUsbPacketBytes - kModemStatusBytes;

// Requests to endpoint 0: vendor's, host to device, index 0, no data stage.
inline constexpr std::uint8_t kRequestType = 0x40;
inline constexpr std::uint8_t kRequestReset = 0;
inline constexpr std::uint16_t kPurgeRx = 1;  // what the processor sent and nobody has fetched
inline constexpr std::uint16_t kPurgeTx = 2;  // what was written and is not yet on the serial line
inline constexpr std::uint8_t kRequestModemLines = 1;
inline constexpr std::uint16_t kDtrHigh = 0x0101;
inline constexpr std::uint16_t kDtrLow = 0x0100;
inline constexpr std::uint16_t kRtsHigh = 0x0202;
inline constexpr std::uint16_t kRtsLow = 0x0200;
inline constexpr std::uint8_t kRequestFlowControl = 2;
inline constexpr std::uint16_t kFlowOff = 0;
inline constexpr std::uint8_t kRequestBaudDivisor = 3;
inline constexpr std::uint16_t kDivisor9600 = 0x4138;    // 312.5 of 3 MHz
inline constexpr std::uint16_t kDivisorUpload = 0x0015;  // 21: 142 857 baud, called 140 000
inline constexpr std::uint16_t kDivisorRun = 0x0002;     // 1.5 Mbaud
inline constexpr std::uint8_t kRequestLineFormat = 4;
inline constexpr std::uint16_t kLine8n1 = 0x0008;
inline constexpr std::uint8_t kRequestLatencyTimer = 9;
inline constexpr std::uint16_t kLatencyBoot_ms = 16;  // with less the boot-loader's check failed
inline constexpr std::uint16_t kLatencyRun_ms = 1;

// Boot-loader: after power-up there is no firmware; what is uploaded is lost with the power.
// At 9600 baud, RTS low and DTR risen: the host asks who is there.
inline constexpr std::array<std::uint8_t, 3> kBootQuestion{0x0a, 0x43, 0x0d};
inline constexpr std::array<std::uint8_t, 4> kBootAnswer{0x0a, 0x44, 0x2c, 0x0d};
inline constexpr int kBootQuestions = 100;  // how often it is asked before giving up
// At the upload's divisor and DTR low: one byte announces the image and is echoed. A comment of the
// source says 0x40, its code 0x41.
inline constexpr std::uint8_t kUploadMark = 0x41;
// Then the raw image. The device echoes every byte, and that is the only check there is.
inline constexpr std::size_t kUploadChunkBytes = 62;
inline constexpr int kUploads = 10;  // customary number of complete uploads before giving up

// Images of the vendor, whose licence forbids to ship them: a person brings one.
struct FirmwareImage {
  std::string_view file;
  std::size_t size_bytes;
  std::string_view sha256;
};
inline constexpr std::array<FirmwareImage, 4> kKnownImages{{
    {"nvent_firmware.bin", 8492,
     "1119e39c39fab1f37678ea62dfc715b23dd86ee7f13d78f88f707d9f09b896a1"},
    {"novint_T0.bin", 7914, "ae838730af34b5822c9c3949859b446614af0410730b832cc17a6ad627ea64a4"},
    {"novint_T2.bin", 7914, "e0ae3598670fa1c8d9277bd6943c99b3152b97c400c46c1c42c60de77ff4e816"},
    {"test_firmware.bin", 7324, "b2700d5cd5ca217e48565fb4de5a502a636c53f6e01ebd0cad193e9f84856c6a"},
}};
// A boot stream of the processor's maker begins so, and with zeros behind it.
inline constexpr std::array<std::uint8_t, 2> kImageBegin{0xaa, 0x08};

// Run mode. One packet from the host yields one of the device, which never talks unasked.
//   byte       0    1-4       5-8       9-12      13            14             15
//   to arm     '<'  motor 1   motor 2   motor 3   'A' + flags   'A'            '>'
//   from arm   '<'  encoder 1 encoder 2 encoder 3 'A' + flags   (unknown)      '>'
// Numbers are two's complement of 16 bits, four nibbles each, the least significant first; a nibble
// is written as 'A' + its value.
inline constexpr std::size_t kRunBytes = 16;
inline constexpr std::uint8_t kRunBegin = 0x3c;
inline constexpr std::uint8_t kRunEnd = 0x3e;
inline constexpr std::uint8_t kNibbleZero = 0x41;
inline constexpr std::size_t kNibblesPerNumber = 4;
inline constexpr std::size_t kFirstNumberByte = 1;
inline constexpr std::size_t kFlagsByte = 13;
inline constexpr std::size_t kUnknownByte = 14;

// To the arm. The order is that of the source's code; a comment beside it has another (0x02 red,
// 0x04 green, 0x08 blue, 0x10 homing). To be checked on an arm.
inline constexpr std::uint8_t kHomingOn = 0x01;
inline constexpr std::uint8_t kLedGreen = 0x02;
inline constexpr std::uint8_t kLedBlue = 0x04;
inline constexpr std::uint8_t kLedRed = 0x08;
// From the arm.
inline constexpr std::uint8_t kButtons = 0x0f;
inline constexpr std::uint8_t kButtonRight = 0x01;
inline constexpr std::uint8_t kButtonForward = 0x02;
inline constexpr std::uint8_t kButtonCentre = 0x04;
inline constexpr std::uint8_t kButtonLeft = 0x08;
// Encoders 1, 2, 3 (top, right, left) know their origin; they jump to it when the bit rises. Valid
// while the host says kHomingOn.
inline constexpr std::array<std::uint8_t, 3> kHomed{0x10, 0x20, 0x40};
inline constexpr std::uint8_t kAllHomed = 0x70;

// The source clamps here; what the firmware does beyond it is unknown.
inline constexpr std::int16_t kMaxMotor_counts = 4095;

// Detecting a firmware that runs: so many packets of zeros; any answer means yes.
inline constexpr int kDetectRounds = 10;

// Full-speed frame and latency timer; the serial line adds 107 us each way. So a sample takes more
// than one: FalconDevice's sample_period is two (decision 0259).
inline constexpr Duration kFramePeriod = std::chrono::milliseconds(1);
// A watchdog of the device is unknown: assume none.
inline constexpr Duration kWatchdog{};

}  // namespace thimble::falcon::wire
