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
// report passes where hidraw's one lock is held (docs/decisions/0358-hidraw-has-one-lock.md).

// "/dev/usb/hiddev0" of the device whose HID device `hid` is; empty where the kernel makes none:
// what is on no USB, what is for input only. Thread: that of its udev. Not RT.
[[nodiscard]] std::string hiddev_node_of(udev_device* hid);

// Whether the only output report of the device at `hiddev` has no number and is `bytes` bytes, one
// value each: such a one goes out as it was given. Thread: any. Not RT.
[[nodiscard]] bool takes_plain_bytes(int hiddev, std::size_t bytes, DeviceCalls& calls) noexcept;

// One output report of a device that takes plain bytes.
//
// Thread: one. RT: no allocation; send() waits in the kernel until the device took it, about a
// frame, at most 10 s (usbhid_wait_io()). It is under way before anything waits.
class HiddevReport {
 public:
  // Of `bytes`, at most kMaxBytes; the rest is left out.
  explicit HiddevReport(std::span<const std::uint8_t> bytes) noexcept;
  // True: the kernel took it, which does not say that the device did.
  bool send(int hiddev, DeviceCalls& calls) noexcept;

  static constexpr std::size_t kMaxBytes = HID_MAX_MULTI_USAGES;

 private:
  hiddev_usage_ref_multi values_{};
  hiddev_report_info report_{};
};

}  // namespace thimble::linux
