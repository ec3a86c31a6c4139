#pragma once

#include <linux/hiddev.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "hal/linux/device_calls.hpp"

struct udev_device;

namespace thimble::linux {

// The kernel's other interface to a HID device on USB (Documentation/hid/hiddev.rst), beside
// hidraw: reports are sets of values there. It takes no lock but that device's own, so that a
// report passes where hidraw's one lock is held (docs/decisions/0358-hidraw-has-one-lock.md), and
// one that hangs holds nobody else up (0488-an-arms-reports-leave-over-hiddev.md).

// "/dev/usb/hiddev0" of the device whose HID device `hid` is; empty where the kernel makes none:
// what is on no USB, what is for input only. Thread: that of its udev. Not RT.
[[nodiscard]] std::string hiddev_node_of(udev_device* hid);

// Whether the only output report of the device at `hiddev` has no number and is `bytes` bytes, one
// value each: such a one goes out as it was given. Thread: any. Not RT.
[[nodiscard]] bool takes_plain_bytes(int hiddev, std::size_t bytes, DeviceCalls& calls) noexcept;

// Lets the kernel ask the device at `hiddev` for all its reports, which it does once a plugging and
// would else do before the first one that is sent: whoever reads from the device then has the
// answers for what it says by itself (usbhid_init_reports()). A device need not answer. Thread:
// any; waits for the kernel, 10 s for each report of a device that says nothing at all. Not RT.
void have_reports_asked_for(int hiddev, DeviceCalls& calls) noexcept;

// Where the output reports of a device that takes plain bytes leave, whose reports were asked for.
//
// Thread: one. RT: no allocation; write() waits in the kernel until the device took it, about a
// frame, at most 10 s (usbhid_wait_io()); before that for another write to the same device, as long
// as that one lasts. Once it waits for the device it leaves after what was written before, whatever
// becomes of the process. Ownership: the opened node and the calls must outlive it.
//
// The values that leave are the device's, not the writer's: of two processes that write at once one
// may send what the other one set. Who has the last word (a guard) says it several times.
class HiddevOutput {
 public:
  HiddevOutput(int hiddev, DeviceCalls& calls) noexcept;
  // A whole one: of a shorter one the rest is what was set last, of more than kMaxBytes the rest is
  // left out. True: the kernel took it, which does not say that the device did: the kernel answers
  // so whatever became of it.
  bool write(std::span<const std::uint8_t> report) noexcept;

  static constexpr std::size_t kMaxBytes = HID_MAX_MULTI_USAGES;

 private:
  int hiddev_;
  DeviceCalls* calls_;
  hiddev_usage_ref_multi values_{};
  hiddev_report_info report_{};
};

}  // namespace thimble::linux
