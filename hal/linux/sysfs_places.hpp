#pragma once

#include <string>
#include <vector>

namespace thimble::linux {

// Where in sysfs to read of a device, and what tells that it is still the same one.
struct SysfsPlace {
  std::string path;      // below /sys/devices
  std::string identity;  // another one after it was plugged in anew
  // Path of the USB device that this is, or is below, which is that of its port: the same for
  // whatever is plugged in there later. Of what is on no USB its own.
  std::string device;
};

// HID nodes, then serial ports on USB, then USB devices but hubs, each in the order of their paths.
//
// Waits for no device: folders, links, and two numbers of the kernel's own (`devnum` and
// `bDeviceClass`: drivers/usb/core/sysfs.c formats them from memory). Not by libudev, which reads
// the `uevent` of whatever it lists; kernels of the 6.1 series show that behind the device's lock
// (uevent_show() in drivers/base/core.c), which is held for as long as a device is probed.
//
// `sys`: where sysfs is; another folder for tests.
// Thread: any. Not RT. Errors: what cannot be read is not there. Total.
[[nodiscard]] std::vector<SysfsPlace> sysfs_places(const std::string& sys = "/sys");

}  // namespace thimble::linux
