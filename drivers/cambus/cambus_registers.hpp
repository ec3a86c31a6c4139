#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

// The 29 registers of a CAM module: numbers only. Driver and simulator share this file and
// cambus_wire.hpp, never a codec.
//
// Source: STEP Technical Reference, draft of 28 June 1993, chapter 6; names of the registers, waits
// and defaults: MIT's control software, step/step-regs.fth (facts; docs/cambus.md, section 2).
namespace thimble::cambus {

inline constexpr int kLayers = 16;
inline constexpr int kAddressBits = 24;
inline constexpr std::size_t kTableEntries = 65536;
inline constexpr int kMaxModules = 64;
inline constexpr std::array<int, 2> kLog2ModuleSites{22, 24};  // by the DRAM of a chip
// Of the machine, by the host card's bus: those that MIT's software has display tables for.
inline constexpr std::array<int, 3> kClocks_mhz{20, 21, 25};

enum class Register : std::uint8_t {
  Select,
  Run,
  Kick,
  SaBit,
  LutSrc,
  FlySrc,
  SiteSrc,
  EventSrc,
  Display,
  ShowScan,
  Event,
  LutIndex,
  LutPerm,
  LutIo,
  ScanIndex,
  ScanPerm,
  ScanIo,
  ScanFormat,
  Offset,
  Dimension,
  Environment,
  Multi,
  Connect,
  ModuleId,
  GroupId,
  IntEnable,
  IntFlags,
  Verify,
  DramCount,
};
inline constexpr std::size_t kRegisterCount = 29;

// Which codes of a field mean something.
enum class Codes : std::uint8_t {
  Any,
  AddressBit,      // 0 to 23
  AddressBitOr01,  // and 30, 31: constants 0 and 1
  TableIndexOr01,  // 0 to 15, and 30, 31
};
inline constexpr std::uint32_t kConstant0 = 30;
inline constexpr std::uint32_t kConstant1 = 31;

[[nodiscard]] constexpr bool means_something(Codes codes, std::uint32_t value) noexcept {
  if (codes == Codes::Any) return true;
  if (codes != Codes::AddressBit && (value == kConstant0 || value == kConstant1)) return true;
  return value < (codes == Codes::TableIndexOr01 ? 16U : 24U);
}

struct Field {
  Register of;
  std::string_view name;
  std::uint8_t first_bit;
  std::uint8_t bits;
  std::uint32_t initial{0};  // what MIT's software writes where a program says nothing
  Codes codes{Codes::Any};
};

namespace field {
inline constexpr std::array<Field, 2> kSelect{{
    {Register::Select, "source", 0, 1, 1},
    {Register::Select, "target", 1, 2, 3},
}};
inline constexpr std::array<Field, 5> kRun{{
    {Register::Run, "sync", 0, 2, 3},
    {Register::Run, "type", 2, 1},
    {Register::Run, "new-count", 3, 1},
    {Register::Run, "repeat-kick", 4, 1},
    {Register::Run, "new-table", 5, 1},
}};
inline constexpr std::array<Field, 7> kKick{{
    {Register::Kick, "amount", 0, 24},
    {Register::Kick, "sign-x", 24, 1},
    {Register::Kick, "sign-y", 25, 1},
    {Register::Kick, "sign-z", 26, 1},
    {Register::Kick, "max-x", 27, 1},
    {Register::Kick, "max-y", 28, 1},
    {Register::Kick, "max-z", 29, 1},
}};
inline constexpr std::array<Field, 1> kSaBit{{
    {Register::SaBit, "bit", 0, 5, 0, Codes::AddressBit},
}};
// The five destinations of the data stream: a source, and how the glued site bit joins it.
template <Register R>
inline constexpr std::array<Field, 2> kSource{{
    {R, "select", 0, 2, 3},
    {R, "map", 2, 4, R == Register::SiteSrc ? 10U : 0U},
}};
inline constexpr std::array<Field, 1> kShowScan{{{Register::ShowScan, "show", 0, 1}}};
inline constexpr std::array<Field, 1> kEvent{{{Register::Event, "count", 0, 25}}};
inline constexpr std::array<Field, 1> kLutIndex{{{Register::LutIndex, "index", 0, 16}}};
inline constexpr std::array<Field, 1> kLutPerm{{
    {Register::LutPerm, "bit", 0, 5, 0, Codes::TableIndexOr01},
}};
inline constexpr std::array<Field, 1> kScanIndex{{{Register::ScanIndex, "index", 0, 24}}};
[[nodiscard]] constexpr Field scan_perm(std::string_view name, int bit) noexcept {
  return {Register::ScanPerm,
          name,
          static_cast<std::uint8_t>(5 * bit),
          5,
          static_cast<std::uint32_t>(bit),
          Codes::AddressBitOr01};
}
inline constexpr std::array<Field, kAddressBits> kScanPerm{
    scan_perm("a0", 0),   scan_perm("a1", 1),   scan_perm("a2", 2),   scan_perm("a3", 3),
    scan_perm("a4", 4),   scan_perm("a5", 5),   scan_perm("a6", 6),   scan_perm("a7", 7),
    scan_perm("a8", 8),   scan_perm("a9", 9),   scan_perm("a10", 10), scan_perm("a11", 11),
    scan_perm("a12", 12), scan_perm("a13", 13), scan_perm("a14", 14), scan_perm("a15", 15),
    scan_perm("a16", 16), scan_perm("a17", 17), scan_perm("a18", 18), scan_perm("a19", 19),
    scan_perm("a20", 20), scan_perm("a21", 21), scan_perm("a22", 22), scan_perm("a23", 23),
};
inline constexpr std::array<Field, 8> kScanFormat{{
    {Register::ScanFormat, "mode", 0, 2},
    {Register::ScanFormat, "end-of-scan", 2, 5},
    {Register::ScanFormat, "end-of-sweep", 7, 4},
    {Register::ScanFormat, "end-of-stretch", 11, 4},
    {Register::ScanFormat, "sweeps-between-refresh", 15, 5, 1},
    {Register::ScanFormat, "refresh-length", 20, 8, 5},
    {Register::ScanFormat, "event-length", 28, 5, 25},
    {Register::ScanFormat, "magnification", 33, 2},
}};
inline constexpr std::array<Field, 1> kOffset{{{Register::Offset, "offset", 0, 24}}};
inline constexpr std::array<Field, 4> kDimension{{
    {Register::Dimension, "cuts", 0, 23},
    {Register::Dimension, "pointer-x", 23, 5, 31, Codes::AddressBitOr01},
    {Register::Dimension, "pointer-y", 28, 5, 31, Codes::AddressBitOr01},
    {Register::Dimension, "pointer-z", 33, 5, 31, Codes::AddressBitOr01},
}};
inline constexpr std::array<Field, 8> kEnvironment{{
    {Register::Environment, "lut-pipeline", 0, 1},
    {Register::Environment, "fly-pipeline", 1, 1},
    {Register::Environment, "dram-size", 2, 1},
    {Register::Environment, "tree-delay", 3, 6},
    {Register::Environment, "test-mode", 9, 4},
    {Register::Environment, "bypass", 13, 1},
    {Register::Environment, "select-read", 14, 1},
    {Register::Environment, "active-table", 15, 1},
}};
inline constexpr std::array<Field, 2> kMulti{{
    {Register::Multi, "pin-a", 0, 5},
    {Register::Multi, "pin-b", 5, 5},
}};
// In the order of the glue pins: XM, XP, YM, YP, ZM, ZP.
inline constexpr std::array<Field, 6> kConnect{{
    {Register::Connect, "xm", 0, 3},
    {Register::Connect, "xp", 3, 3, 1},
    {Register::Connect, "ym", 6, 3, 2},
    {Register::Connect, "yp", 9, 3, 3},
    {Register::Connect, "zm", 12, 3, 4},
    {Register::Connect, "zp", 15, 3, 5},
}};
inline constexpr std::array<Field, 1> kModuleId{{{Register::ModuleId, "id", 0, 1}}};
inline constexpr std::array<Field, 1> kGroupId{{{Register::GroupId, "id", 0, 1}}};
// Those whose hardware had no defect.
template <Register R>
inline constexpr std::uint32_t kEnabled = R == Register::IntEnable ? 1U : 0U;
template <Register R>
inline constexpr std::array<Field, 10> kInterrupts{{
    {R, "bus-parity", 0, 1},
    {R, "bus-contention", 1, 1},
    {R, "glue-contention", 2, 1, kEnabled<R>},
    {R, "multi-a", 3, 1},
    {R, "multi-b", 4, 1},
    {R, "skewed-scan", 5, 1, kEnabled<R>},
    {R, "external", 6, 1, kEnabled<R>},
    {R, "register-length", 7, 1, kEnabled<R>},
    {R, "unknown-register", 8, 1, kEnabled<R>},
    {R, "invalid-sync", 9, 1, kEnabled<R>},
}};
inline constexpr std::array<Field, 3> kVerify{{
    {Register::Verify, "enable", 0, 1},
    {Register::Verify, "interrupt-enable", 1, 1},
    {Register::Verify, "flag", 2, 1},
}};
inline constexpr std::array<Field, 2> kDramCount{{
    {Register::DramCount, "low", 0, 8},
    {Register::DramCount, "high", 8, 8},
}};

// Fields that programs and lists are about.
inline constexpr const Field& kSync = kRun[0];
inline constexpr const Field& kRunType = kRun[1];
inline constexpr const Field& kNewCount = kRun[2];
inline constexpr const Field& kRepeatKick = kRun[3];
inline constexpr const Field& kNewTable = kRun[4];
inline constexpr const Field& kKickAmount = kKick[0];
inline constexpr const Field& kScanMode = kScanFormat[0];
inline constexpr const Field& kEndOfScan = kScanFormat[1];
inline constexpr const Field& kEndOfSweep = kScanFormat[2];
inline constexpr const Field& kEndOfStretch = kScanFormat[3];
inline constexpr const Field& kSweepsBetweenRefresh = kScanFormat[4];
inline constexpr const Field& kRefreshLength = kScanFormat[5];
inline constexpr const Field& kEventLength = kScanFormat[6];
inline constexpr const Field& kCuts = kDimension[0];
}  // namespace field

// Values of fields that have a meaning each.
inline constexpr std::uint32_t kSyncNone = 0;
inline constexpr std::uint32_t kSyncFrame = 1;
inline constexpr std::uint32_t kSyncLine = 2;
inline constexpr std::uint32_t kSyncFree = 3;
inline constexpr std::uint32_t kSelectUnglued = 0;
inline constexpr std::uint32_t kSelectHost = 1;
inline constexpr std::uint32_t kSelectFlywheel = 2;
inline constexpr std::uint32_t kSelectLutOrAddress = 3;
// Of a map: bit (2 * selected source + glued site bit).
inline constexpr std::uint32_t kMapZero = 0;
inline constexpr std::uint32_t kMapSite = 10;
inline constexpr std::uint32_t kMapSource = 12;
inline constexpr std::uint32_t kMapOne = 15;
// Of the select register: what has to match, and what it has to be.
inline constexpr std::uint32_t kSourceModuleId = 0;
inline constexpr std::uint32_t kSourceGroupId = 1;
inline constexpr std::uint32_t kTargetZero = 0;
inline constexpr std::uint32_t kTargetOne = 1;
inline constexpr std::uint32_t kTargetTableIndex = 2;
inline constexpr std::uint32_t kTargetSpecial = 3;  // id: the AND of the glue is 0; group: any
// Of a glue pin: 0 to 5 are ports; these it drives itself.
inline constexpr std::uint32_t kPinIs0 = 6;
inline constexpr std::uint32_t kPinIs1 = 7;
inline constexpr std::uint32_t kEventBits = 25;

struct RegisterFacts {
  Register number;
  std::string_view name;
  std::uint8_t bits;  // 0: a port, whose transfers say how long they are
  bool waits;         // a transfer has to wait for the end of a scan
  std::span<const Field> fields;
};

inline constexpr std::array<RegisterFacts, kRegisterCount> kRegisters{{
    {Register::Select, "select", 3, false, field::kSelect},
    {Register::Run, "run", 6, true, field::kRun},
    {Register::Kick, "kick", 30, true, field::kKick},
    {Register::SaBit, "sa-bit", 5, true, field::kSaBit},
    {Register::LutSrc, "lut-src", 6, true, field::kSource<Register::LutSrc>},
    {Register::FlySrc, "fly-src", 6, true, field::kSource<Register::FlySrc>},
    {Register::SiteSrc, "site-src", 6, true, field::kSource<Register::SiteSrc>},
    {Register::EventSrc, "event-src", 6, true, field::kSource<Register::EventSrc>},
    {Register::Display, "display", 6, true, field::kSource<Register::Display>},
    {Register::ShowScan, "show-scan", 1, false, field::kShowScan},
    {Register::Event, "event", 25, false, field::kEvent},
    {Register::LutIndex, "lut-index", 16, false, field::kLutIndex},
    {Register::LutPerm, "lut-perm", 5, false, field::kLutPerm},
    {Register::LutIo, "lut-io", 0, false, {}},
    {Register::ScanIndex, "scan-index", 24, true, field::kScanIndex},
    {Register::ScanPerm, "scan-perm", 120, true, field::kScanPerm},
    {Register::ScanIo, "scan-io", 0, true, {}},
    {Register::ScanFormat, "scan-format", 35, true, field::kScanFormat},
    {Register::Offset, "offset", 24, true, field::kOffset},
    {Register::Dimension, "dimension", 38, true, field::kDimension},
    {Register::Environment, "environment", 16, true, field::kEnvironment},
    {Register::Multi, "multi", 10, false, field::kMulti},
    {Register::Connect, "connect", 18, true, field::kConnect},
    {Register::ModuleId, "module-id", 1, false, field::kModuleId},
    {Register::GroupId, "group-id", 1, false, field::kGroupId},
    {Register::IntEnable, "int-enable", 10, false, field::kInterrupts<Register::IntEnable>},
    {Register::IntFlags, "int-flags", 10, false, field::kInterrupts<Register::IntFlags>},
    {Register::Verify, "verify", 3, false, field::kVerify},
    {Register::DramCount, "dram-count", 16, true, field::kDramCount},
}};
inline constexpr std::size_t kMaxRegisterBits = 120;

[[nodiscard]] constexpr const RegisterFacts& facts_of(Register number) noexcept {
  return kRegisters[static_cast<std::size_t>(number)];
}

}  // namespace thimble::cambus
