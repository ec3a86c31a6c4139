#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

// The carriage of a board's page and window over USB: numbers only, shared with the simulator.
//
// Source: docs/cambus.md, section 7 (all of it ours).
namespace thimble::cambus::usb {

inline constexpr std::string_view kProduct = "CAM-8 board";
inline constexpr std::uint8_t kInterface = 0;
inline constexpr std::uint8_t kRequests = 0x01;  // bulk OUT
inline constexpr std::uint8_t kReplies = 0x81;   // bulk IN
inline constexpr std::size_t kFullSpeedPacketBytes = 64;

// A request and a reply: byte offsets in their beginning, which the payload follows.
inline constexpr std::size_t kHeaderBytes = 16;
inline constexpr std::size_t kAtMagic = 0;  // 16 bits
inline constexpr std::size_t kAtKind = 2;
inline constexpr std::size_t kAtStatus = 3;
inline constexpr std::size_t kAtNumber = 4;  // 16 bits
inline constexpr std::size_t kAtWords = 6;   // 16 bits
inline constexpr std::size_t kAtOffset = 8;  // 32 bits
inline constexpr std::size_t kAtCheck = 12;  // 32 bits, of what is before and behind it
inline constexpr std::size_t kMostWords = 16'384;
inline constexpr std::size_t kMostBytes = kHeaderBytes + 4 * kMostWords;

inline constexpr std::uint16_t kRequestMagic = 0x4243;
inline constexpr std::uint16_t kReplyMagic = 0x4342;
inline constexpr std::uint32_t kCrcPolynomial = 0xedb88320;  // IEEE 802.3, reflected

enum class Kind : std::uint8_t { None, Read, Write, Begin };
enum class Status : std::uint8_t { Done, Malformed, OutOfRange, NotAligned, OutOfOrder };

// That wait at the board for the host to fetch them.
inline constexpr std::size_t kMostReplies = 8;
inline constexpr std::size_t kMostReplyBytes = 128 * 1024;

}  // namespace thimble::cambus::usb
