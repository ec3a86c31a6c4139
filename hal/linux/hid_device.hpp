#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/linux/hid_connection.hpp"

namespace thimble::linux {

// Opens the HID devices of this machine, and looks after those whose closing takes long.
//
// A device that it opened is bus::HidDevice: read_newest() is served from a mailbox, without a
// system call, since hidapi would need two for every report that waits (poll and read); submit()
// writes to one eventfd. A write that the kernel does not end shows as Backlogged and in the age
// of the samples, never as a wait. Reports longer than kMaxHidReportBytes are lost. Of what was
// submitted when it is closed the newest is still written, then nothing.
//
// Thread: control plane, one thread; the devices as bus::HidDevice. Not RT.
// Ownership: must outlive the devices. The destructor waits for the kernel, up to 5 s for a device
// that takes nothing.
class HidHost {
 public:
  explicit HidHost(BusSettings settings) : settings_(std::move(settings)) {}

  // `nodes` are those of the device that `info` describes. Waits kPatience twice at most.
  // NotFound, Permission, System; Busy when a daemon holds it, when it is not closed yet, or while
  // the kernel still writes to some HID device: try again. Unsupported for reports that are too
  // long.
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open(const HidNodes& nodes,
                                                             const bus::BusDeviceInfo& info);
  // Devices that are closed for their users, but not yet for the kernel.
  [[nodiscard]] std::size_t lingering();

  // Of the control plane, with an opening; ours: one that is not held up takes a tenth of it.
  static constexpr Duration kPatience = std::chrono::milliseconds(250);
  // And with a closing, which nobody needs the end of: as long as it takes when no write hangs.
  static constexpr Duration kClosingPatience = std::chrono::milliseconds(50);

 private:
  class Device;
  // Waits kClosingPatience, and keeps a connection that the kernel holds up for longer.
  void close(std::unique_ptr<HidConnection> connection);

  BusSettings settings_;
  std::mutex opening_;
  std::vector<std::unique_ptr<HidConnection>> closing_;
};

}  // namespace thimble::linux
