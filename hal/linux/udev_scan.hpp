#pragma once

#include <functional>
#include <mutex>
#include <vector>

#include "hal/linux/device_readings.hpp"
#include "hal/linux/udev_handles.hpp"

namespace thimble::linux {

// Looks at the machine's HID devices, serial ports on USB, and USB devices: where they are through
// sysfs (sysfs_places.hpp), what they are through libudev, in a thread beside: descriptors and
// strings as the kernel keeps them since each was plugged in. Opens no device and sends nothing to
// any.
//
// Whatever a device says is bounded and total (device_texts.hpp): strings are cut after 256 bytes,
// descriptors that do not parse give a device without reports or endpoints.
//
// The kernel keeps the strings of a USB device, and its `uevent`, behind that device's lock, for as
// long as it talks to it: up to seconds where it answers nothing. Such a device waits for its own
// answer alone: device_readings.hpp.
//
// Thread: any. Not RT. Ownership: none shared. Errors: what cannot be read is left out.
class UdevScan {
 public:
  // Whether a driver knows such a device: its address is then its own (hid_address.hpp). Asked in
  // the thread that looks, and so in several at once.
  using IsArm = std::function<bool(const bus::BusDeviceInfo&)>;
  explicit UdevScan(IsArm is_arm = {});
  ~UdevScan();
  UdevScan(const UdevScan&) = delete;
  UdevScan& operator=(const UdevScan&) = delete;

  // HID devices, then serial ports, then USB devices but hubs; also those whose rules udevd is
  // about to apply: who may not open one yet tries again. Waits kPatience for the first that is
  // held up, and kFurtherPatience for each that is from then on; and for a look of another thread.
  [[nodiscard]] std::vector<FoundDevice> devices();
  // Whether something came or went since the last call, as far as udevd tells, or can be read at
  // last. Never waits: during a look it says no, and remembers.
  [[nodiscard]] bool has_news() noexcept;

  // Ours. Of who opens an arm or lists what is there; a device that is not held up is read within a
  // millisecond, of a busy machine within some hundred.
  static constexpr Duration kPatience = std::chrono::milliseconds(2000);
  static constexpr Duration kFurtherPatience = std::chrono::milliseconds(20);

 private:
  [[nodiscard]] std::vector<ReadDevice> read_all();

  const IsArm is_arm_;
  std::mutex looking_;
  UdevHandle<udev> context_;
  UdevHandle<udev_monitor> monitor_;  // nullptr: nobody tells
  DeviceReadings readings_;
};

}  // namespace thimble::linux
