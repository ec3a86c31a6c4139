#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/hid_mailboxes.hpp"
#include "hal/linux/hiddev.hpp"

struct hid_device_;

namespace thimble::linux {

// What the bus does with an opened HID device: hidapi's calls, on a node of the kernel's hidraw.
// One handle to read, and where the device has no hiddev that takes plain bytes another one of the
// same node to write: a write may last, and hidapi's memory of its last error is one of the handle
// and takes no second thread. Where it has one it is written over that alone
// (docs/decisions/0488-an-arms-reports-leave-over-hiddev.md).
//
// The node is locked (flock) against another daemon. hidapi's words for errors are not used.
//
// Thread: open() and the destructor from one; receive() from one, send() from one: three threads
// or fewer. hidapi's memory of errors wants one opening at a time in the process: one mutex for
// all. Not RT: the kernel (6.1, hidraw.c) holds one lock over all HID devices during a write to
// hidraw, which may last 5 s on one whose device takes nothing, and wants the same lock to open and
// to close any of them. A write over hiddev holds no other device up, and may last 10 s.
// Ownership: the mailboxes and the clock must outlive it, and what `hiddev` needs.
// Errors: Result when opening; a device that is gone shows in the mailboxes.
class HidTransfers {
 public:
  // `node` must be a hidraw node: libhidapi before 0.14 reads freed memory on others. A device
  // with numbered reports gets and gives their numbers as first byte: `has_report_ids`.
  // `hidapi` is held only while hidapi opens the node, which it has been opened for before.
  // `hiddev`: where its reports leave, of a device that takes plain bytes there; else over hidraw.
  // NotFound, Permission, Busy (another process has locked it) or System.
  [[nodiscard]] static Result<std::unique_ptr<HidTransfers>> open(
      const std::string& node, bool has_report_ids, bus::HidMailboxes& mail, const Clock& clock,
      std::mutex& hidapi, std::optional<HiddevOutput> hiddev);
  ~HidTransfers();
  HidTransfers(const HidTransfers&) = delete;
  HidTransfers& operator=(const HidTransfers&) = delete;

  // Brings one report to the mailbox. Waits for it, `wait_ms` at most; false: none came.
  bool receive(int wait_ms) noexcept;
  // Writes what waits in the mailbox, and returns when the kernel does; false: nothing waited.
  bool send() noexcept;

 private:
  HidTransfers(int lock, bool has_report_ids, bus::HidMailboxes& mail, const Clock& clock,
               const std::optional<HiddevOutput>& hiddev) noexcept
      : lock_(lock),
        has_report_ids_(has_report_ids),
        mail_(&mail),
        clock_(&clock),
        hiddev_(hiddev) {}
  bool write_to_hidraw(std::span<const std::uint8_t> report) noexcept;

  int lock_;
  bool has_report_ids_;
  bus::HidMailboxes* mail_;
  const Clock* clock_;
  hid_device_* reading_{nullptr};
  std::optional<HiddevOutput> hiddev_;
  hid_device_* writing_{nullptr};  // where there is no hiddev
};

}  // namespace thimble::linux
