#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

// The page of a board over PCI, and its four host registers: numbers only, shared with the
// simulator.
//
// Source: docs/cambus.md, sections 4 (registers: STEP Technical Reference and MIT's
// step/step-list.fth) and 6 (the page: ours).
namespace thimble::cambus::page {

inline constexpr std::uint32_t kPageBytes = 0x1000;
inline constexpr std::size_t kHostRegisters = 4;
inline constexpr std::size_t kInterrupts = 5;  // soft, machine, bus, timeout, new list

// Byte offsets. Written by the board; the first eight words do not change while it runs, but for
// the beat.
inline constexpr std::uint32_t kMagic = 0x000;
inline constexpr std::uint32_t kVersion = 0x004;
inline constexpr std::uint32_t kWindowOffset = 0x008;
inline constexpr std::uint32_t kWindowBytes = 0x00c;
inline constexpr std::uint32_t kShape = 0x010;  // modules along x, y, z; then log2 of their sites
inline constexpr std::uint32_t kClockHz = 0x014;
inline constexpr std::uint32_t kIncarnation = 0x018;
inline constexpr std::uint32_t kBeat = 0x01c;
inline constexpr std::uint32_t kIdentityBytes = 0x020;
// Written by the host.
inline constexpr std::uint32_t kWritten = 0x400;
inline constexpr std::uint32_t kMeant = 0x410;
inline constexpr std::uint32_t kDoorbell = 0x414;
// Written by the board.
inline constexpr std::uint32_t kRead = 0x800;
inline constexpr std::uint32_t kAcknowledge = 0x810;
inline constexpr std::uint32_t kRaised = 0x814;  // counts
inline constexpr std::uint32_t kMoment = 0x828;  // odd while the words of kRead to here change
inline constexpr std::uint32_t kStatusBytes = kMoment + 4 - kRead;

inline constexpr std::uint32_t kMagicValue = 0x384d4143;  // CAM8
inline constexpr std::uint32_t kVersionValue = 1;

// Milliseconds: a board's beat counts up at least so often; a host that sees the same one after so
// long gives it up, however seldom it looked.
inline constexpr int kBeatAtLeastEvery_ms = 100;
inline constexpr int kBeatGivenUp_ms = 300;

// The host registers, written: 0 next list, 1 control, 2 and 3 display lengths.
inline constexpr std::uint32_t kListPointer = 0xfffffff0;  // of 0, read and written
inline constexpr std::uint32_t kInterruptMask = 0x1f;      // of 1: these bits disable
inline constexpr unsigned kEnableShift = 8;                // and these enable
inline constexpr std::uint32_t kClearFault = 1U << 13;
inline constexpr std::uint32_t kClearException = 1U << 14;
inline constexpr std::uint32_t kHalt = 1U << 15;
inline constexpr std::uint32_t kResetInterface = 1U << 31;
// Of the word that says which are meant.
inline constexpr std::uint32_t kNextList = 1U << 0;
inline constexpr std::uint32_t kControl = 1U << 1;
inline constexpr std::uint32_t kScanLength = 1U << 2;
inline constexpr std::uint32_t kBlankLength = 1U << 3;

inline constexpr std::uint32_t kLengthMask = 0xffff;  // of 2 and 3: clocks of a line,
inline constexpr unsigned kLinesShift = 16;           // and lines of a frame

// Read: low bits of 0, 2 (current instruction) and 3 (previous instruction).
inline constexpr std::uint32_t kIsListPending = 1U << 0;
inline constexpr std::uint32_t kHasException = 1U << 1;
inline constexpr std::uint32_t kIsWaiting = 1U << 2;
inline constexpr std::uint32_t kIsHalted = 1U << 3;
inline constexpr std::uint32_t kHasBusFault = 1U << 0;
inline constexpr std::uint32_t kHasMachineInterrupt = 1U << 0;
inline constexpr std::uint32_t kIsScanning = 1U << 1;

enum class Interrupt : std::uint8_t { Soft, Machine, Bus, Timeout, NewList };

}  // namespace thimble::cambus::page
