#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/bus/hid_device.hpp"
#include "hal/bus/usb_mailboxes.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::bus {

// The driver's end of an opened HID device, and behind it the mailboxes that a bus empties and
// fills. To its host a HID device is two interrupt pipes (HID 1.11, section 4), so it is two
// pipes of UsbMailboxes here.
//
// Thread: HidDevice's side as there; of the bus's side, deliver() from one thread, take_out() and
// finish_out() from one, which may be another; disconnect() from any.
// RT: all but the construction THIMBLE_RT; no system call, no allocation.
class HidMailboxes final : public HidDevice {
 public:
  // Output of any other length is refused. At most kMaxHidReportBytes.
  explicit HidMailboxes(std::size_t output_report_bytes);

  THIMBLE_RT_IO IoStatus read_newest(HidReport& out) noexcept override;
  THIMBLE_RT_IO IoStatus submit(std::span<const std::uint8_t> report) noexcept override;
  // reports_skipped is up to date after a read, writes_superseded when a report has gone out.
  [[nodiscard]] HidCounters counters() const noexcept override;

  // A report arrived. One of more than kMaxHidReportBytes is lost.
  THIMBLE_RT void deliver(std::span<const std::uint8_t> report, MonotonicTime at) noexcept;
  // The newest report that was submitted, or empty. Valid until finish_out(), which it is owed.
  THIMBLE_RT std::span<const std::uint8_t> take_out() noexcept;
  THIMBLE_RT void finish_out(bool is_taken) noexcept;
  THIMBLE_RT void disconnect() noexcept { pipes_.disconnect(); }
  THIMBLE_RT [[nodiscard]] bool is_disconnected() const noexcept {
    return pipes_.is_disconnected();
  }

 private:
  std::size_t output_report_bytes_;
  UsbMailboxes pipes_;
};

}  // namespace thimble::bus
