#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"

struct udev;
struct udev_monitor;

namespace thimble::linux {

// A device that is plugged into this machine.
struct FoundDevice {
  bus::BusDeviceInfo info;
  std::string node;      // "/dev/hidraw0", "/dev/bus/usb/001/004"
  std::string identity;  // another one after it was plugged in anew
};

// Looks at the machine's HID and USB devices through libudev: descriptors and strings as the
// kernel keeps them since each was plugged in. Opens no device and sends nothing to any.
//
// Whatever a device says is bounded and total: strings are cut after 256 bytes, descriptors that
// do not parse give a device without reports or endpoints.
//
// Thread: one. Not RT. Ownership: none shared. Errors: what cannot be read is left out.
class UdevScan {
 public:
  UdevScan();
  ~UdevScan();
  UdevScan(const UdevScan&) = delete;
  UdevScan& operator=(const UdevScan&) = delete;

  // HID devices, then USB devices but hubs; also those whose rules udevd is about to apply: who may
  // not open one yet tries again.
  [[nodiscard]] std::vector<FoundDevice> devices() const;
  // Whether something came or went since the last call, as far as udevd tells. Never waits.
  [[nodiscard]] bool has_news() noexcept;

 private:
  struct Free {
    void operator()(udev* context) const noexcept;
    void operator()(udev_monitor* monitor) const noexcept;
  };

  std::unique_ptr<udev, Free> context_;
  std::unique_ptr<udev_monitor, Free> monitor_;  // nullptr: nobody tells
};

}  // namespace thimble::linux
