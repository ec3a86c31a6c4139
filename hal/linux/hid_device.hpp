#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/linux/hid_connection.hpp"

namespace thimble::linux {

class HidHost;

// A HID device that HidHost opened.
//
// Thread, errors: as bus::HidDevice. RT: submit() writes to one eventfd, read_newest() makes no
// system call; construction and destruction are not. Ownership: the host must outlive it; the
// destructor waits HidHost::kClosingPatience at most, and leaves the rest of the closing to it.
class HidDevice final : public bus::HidDevice {
 public:
  HidDevice(HidHost& host, std::unique_ptr<HidConnection> connection) noexcept
      : host_(&host), connection_(std::move(connection)) {}
  ~HidDevice() override;
  HidDevice(const HidDevice&) = delete;
  HidDevice& operator=(const HidDevice&) = delete;

  // Expires with this. Thread: of who opened it.
  [[nodiscard]] std::weak_ptr<const SharedDevice> shared() const noexcept {
    return connection_->shared();
  }
  IoStatus read_newest(bus::HidReport& out) noexcept override {
    return connection_->mail().read_newest(out);
  }
  IoStatus submit(std::span<const std::uint8_t> report) noexcept override;
  [[nodiscard]] bus::HidCounters counters() const noexcept override {
    return connection_->mail().counters();
  }

 private:
  HidHost* host_;
  std::unique_ptr<HidConnection> connection_;
};

// Opens the HID devices of this machine, and looks after those whose closing takes long.
//
// A device that it opened is linux::HidDevice: read_newest() is served from a mailbox, without a
// system call, since hidapi would need two for every report that waits (poll and read); submit()
// writes to one eventfd. A write that the kernel does not end shows as Backlogged and in the age
// of the samples, never as a wait. Reports longer than kMaxHidReportBytes are lost. Of what was
// submitted when it is closed the newest is still written, then nothing.
//
// Thread: any, one at a time for each device; the devices as bus::HidDevice. Not RT.
// Ownership: must outlive the devices, and the calls it. The destructor waits for the kernel: of a
// device that takes nothing for the report under way and for the last one, over hidraw 10 s
// together, over hiddev 20 and as much again where a guard writes to it meanwhile.
class HidHost {
 public:
  HidHost(BusSettings settings, DeviceCalls& calls)
      : settings_(std::move(settings)), calls_(&calls) {}

  // `nodes` are those of the device that `info` describes. Waits kPatience twice at most.
  // NotFound, Permission, System; Busy when a daemon holds it, when it is not closed yet, or while
  // the kernel still writes to some HID device: try again. Unsupported for reports that are too
  // long.
  [[nodiscard]] Result<std::unique_ptr<HidDevice>> open(const HidNodes& nodes,
                                                        const bus::BusDeviceInfo& info);
  // Devices that are closed for their users, but not yet for the kernel; without one that open() is
  // waiting for just now.
  [[nodiscard]] std::size_t lingering();

  // Of whoever opens one, a thread of the arm as a rule; ours: one that is not held up takes a
  // tenth of it.
  static constexpr Duration kPatience = std::chrono::milliseconds(250);
  // And with a closing, which nobody needs the end of: as long as it takes when no write hangs.
  static constexpr Duration kClosingPatience = std::chrono::milliseconds(50);

 private:
  friend class HidDevice;
  [[nodiscard]] Result<void> await_end_of_older(const bus::DeviceAddress& address);
  [[nodiscard]] std::vector<std::unique_ptr<HidConnection>> take_closing(
      const bus::DeviceAddress& address);
  // Waits kClosingPatience, and keeps a connection that the kernel holds up for longer.
  void close(std::unique_ptr<HidConnection> connection);

  BusSettings settings_;
  DeviceCalls* calls_;
  std::mutex opening_;
  std::mutex closing_list_;  // of:
  std::vector<std::unique_ptr<HidConnection>> closing_;
};

}  // namespace thimble::linux
