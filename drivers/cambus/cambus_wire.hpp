#pragma once

#include <array>
#include <cstdint>

// Step lists as a board fetches them: numbers only, shared with the simulator.
//
// Source: STEP Technical Reference, draft of 28 June 1993, chapter 4; bits of the opcode: MIT's
// control software, step/step-list.fth. Byte order, offsets and limits are ours (docs/cambus.md,
// section 3).
namespace thimble::cambus::wire {

// A descriptor: four 32-bit words, little-endian, at a multiple of its size.
inline constexpr std::uint32_t kDescriptorBytes = 16;
inline constexpr std::uint32_t kOpcodeByte = 0;
inline constexpr std::uint32_t kBufferByte = 4;  // or immediate data
inline constexpr std::uint32_t kLengthByte = 8;  // 16-bit words to move, or clocks of a delay
inline constexpr std::uint32_t kLinkByte = 12;
// A buffer begins at a multiple of it, and its end is rounded up to one.
inline constexpr std::uint32_t kBufferAlignment = 16;
[[nodiscard]] constexpr std::uint64_t buffer_end(std::uint64_t bytes) noexcept {
  return (bytes + kBufferAlignment - 1) / kBufferAlignment * kBufferAlignment;
}
// The window's first bytes hold no descriptor and no buffer: a link of 0 leads nowhere.
inline constexpr std::uint32_t kReservedBytes = 16;

inline constexpr std::uint32_t kRegisterMask = 0x1f;
inline constexpr std::uint32_t kWait = 1U << 12;       // for the end of the scan, first
inline constexpr std::uint32_t kInterrupt = 1U << 13;  // raise the soft interrupt
inline constexpr std::uint32_t kStop = 1U << 14;       // wait for the host; no link
inline constexpr std::uint32_t kJump = 1U << 15;       // to the host's list, if it gave one
inline constexpr std::uint32_t kByteMode = 1U << 28;   // of a read: low bytes, two to a word
inline constexpr std::uint32_t kImmediate = 1U << 29;
inline constexpr std::uint32_t kRead = 1U << 30;
inline constexpr std::uint32_t kDelay = kImmediate | kRead;  // nothing moves
inline constexpr std::uint32_t kReset = 1U << 31;            // with kDelay
inline constexpr std::uint32_t kOpcodeMask =
    kRegisterMask | kWait | kInterrupt | kStop | kJump | kByteMode | kImmediate | kRead | kReset;

// Clocks of a scan (docs/cambus.md, section 5), beyond one for each site.
inline constexpr std::uint32_t kSweepOverhead_clocks = 40;
inline constexpr std::uint32_t kSlowSite_clocks = 4;  // in modes 0 and 1

// After a write to scan-io nothing may move for 40 + 4 * refresh-length + 2 * levels clocks.
inline constexpr std::uint32_t kFlushClocks = 40;
inline constexpr std::uint32_t kClocksPerRefresh = 4;
inline constexpr std::uint32_t kBusLevels = 1;

// What a list may ask for (ours): 0.67 s of waiting in one step, and 2.7 s of words at a clock
// each.
inline constexpr std::uint32_t kMaxDelayClocks = 1U << 24;
inline constexpr std::uint64_t kMaxListWords = std::uint64_t{1} << 26;

// A file is an image of the window from offset 0; what stands in the reserved bytes.
inline constexpr std::array<char, 8> kFileMagic{'C', 'A', 'M', 'L', 'I', 'S', 'T', '1'};
inline constexpr std::uint32_t kFileHeadByte = 8;  // offset of the first descriptor; then 4 zeros

}  // namespace thimble::cambus::wire
