#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/io_status.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::bus {

inline constexpr std::size_t kMaxHidReportBytes = 64;  // full-speed interrupt packet, USB 2.0

// One input report. The arms here number no reports; of a device that does (HID 1.11, 5.6), the
// first byte is the report's number, both ways, and counts as one of its bytes. One that is shorter
// than the device's descriptor says may be lost: Linux 6.1.0-56 of Debian drops it (decision 0375).
struct HidReport {
  std::array<std::uint8_t, kMaxHidReportBytes> bytes{};
  std::size_t size{0};
  MonotonicTime arrived_at{};  // clock of the bus that delivered it
  std::uint64_t sequence{0};   // +1 for every report that arrived, read or not

  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept {
    return {bytes.data(), size};
  }
};

struct HidCounters {
  std::uint64_t reports_in{0};
  std::uint64_t reports_skipped{0};  // arrived but superseded before they were read
  std::uint64_t reports_out{0};
  std::uint64_t writes_superseded{0};  // replaced by a newer one before the bus took them
  std::uint64_t writes_failed{0};      // the bus took them, but not the device, or not all of it
};

// An opened HID device: input reports one way, output reports the other.
//
// Thread: read_newest() and submit() from the one servo thread; counters() from any thread.
// RT: both THIMBLE_RT_IO: an exchange with the bus's mailboxes, at most one non-blocking
//     system call, never a wait. Whatever blocks does so on the bus's own thread.
// Ownership: closing is the destructor's. Of what was submitted before it the newest report is
//     still sent: over a kernel perhaps long afterwards, for a write may last (10 s); a
//     simulated bus, on which no time passes meanwhile, drops it. After it the device ends silent.
// Errors: IoStatus::Disconnected latches.
class HidDevice {
 public:
  virtual ~HidDevice() = default;
  // The newest report that arrived since the last call. Ok, NoData or Disconnected.
  THIMBLE_RT_IO virtual IoStatus read_newest(HidReport& out) noexcept = 0;
  // Hands an output report to the bus, of the device's output_report_bytes (BusDeviceInfo: its
  // longest one, with the number of it where it numbers them), no more and no less; the latest
  // value wins. A shorter report of a device that has several cannot be sent. Ok when nothing is on
  // its way, or a report reached the device since the last submit; else Backlogged, be the last one
  // still on its way or failed (this one waits, and replaces one that waits); Disconnected;
  // ProtocolError for any other size.
  THIMBLE_RT_IO virtual IoStatus submit(std::span<const std::uint8_t> report) noexcept = 0;
  [[nodiscard]] virtual HidCounters counters() const noexcept = 0;
};

}  // namespace thimble::bus
