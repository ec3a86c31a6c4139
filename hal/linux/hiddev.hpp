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

// Where the output reports of a device that takes plain bytes leave.
//
// Thread: one. RT: no allocation; write() waits in the kernel until the device took it, about a
// frame, at most 10 s (usbhid_wait_io()). It is under way before anything waits, after what was
// written before. Ownership: the opened node and the calls must outlive it.
class HiddevOutput {
 public:
  HiddevOutput(int hiddev, DeviceCalls& calls) noexcept;
  // Of a report of more than kMaxBytes the rest is left out. True: the kernel took it, which does
  // not say that the device did: the kernel answers so whatever became of it.
  bool write(std::span<const std::uint8_t> report) noexcept;

  static constexpr std::size_t kMaxBytes = HID_MAX_MULTI_USAGES;

 private:
  int hiddev_;
  DeviceCalls* calls_;
  hiddev_usage_ref_multi values_{};
  hiddev_report_info report_{};
};

}  // namespace thimble::linux
