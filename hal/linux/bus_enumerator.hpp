#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "hal/bus/bus_enumerator.hpp"
#include "hal/linux/bus_settings.hpp"
#include "hal/linux/device_watch.hpp"
#include "hal/linux/hid_device.hpp"
#include "hal/linux/shared_device.hpp"
#include "hal/linux/udev_scan.hpp"

namespace thimble::linux {

// The HID devices, serial ports and USB devices of this machine. Addresses: hid_address.hpp. To
// list opens no device and sends nothing.
//
// Thread: list() and open_*() from any, one at a time for each device: they wait for the kernel,
// for seconds where a device answers nothing, and so does the end of what they opened. poll_event()
// and catch_up() from one, share() from any; poll_event() and share() never wait. Not RT.
// Errors: as bus::BusEnumerator; open_hid() as HidHost::open(), open_usb() as UsbDevice::open(),
// open_serial() as SerialPort::open(). Ownership: must outlive the devices it opened.
class BusEnumerator final : public bus::BusEnumerator {
 public:
  // `is_arm`: as UdevScan's, asked in several threads at once, for as long as this lives. Empty: no
  // device counts as an arm, so a stranger with an arm's serial number takes its address away
  // (docs/decisions/0338-a-serial-number-stays-the-arms.md).
  explicit BusEnumerator(const BusSettings& settings, UdevScan::IsArm is_arm = {});

  [[nodiscard]] std::vector<bus::BusDeviceInfo> list() override;
  // As DeviceWatch.
  [[nodiscard]] std::optional<bus::BusEvent> poll_event() override { return watch_.poll(); }
  void catch_up(Duration patience) { watch_.catch_up(patience); }
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid(
      const bus::DeviceAddress& address) override;
  [[nodiscard]] Result<std::unique_ptr<bus::UsbDevice>> open_usb(
      const bus::DeviceAddress& address, const bus::UsbClaim& claim) override;
  [[nodiscard]] Result<std::unique_ptr<bus::SerialPort>> open_serial(
      const bus::DeviceAddress& address, const bus::SerialLine& line) override;
  // A device that this opened and that is open still, for a process that may have to let the arm go
  // when this one cannot. NotFound or System. Whoever asks sees to it that the device is not closed
  // before he is through with what he got: the end of the last file waits for the kernel, as long
  // as a device that hangs lets it, and would do so in his thread.
  [[nodiscard]] Result<SharedDevice> share(const bus::DeviceAddress& address);

 private:
  [[nodiscard]] Result<FoundDevice> find(const bus::DeviceAddress& address, bus::BusKind kind);
  // NotFound when what was opened by the name of its node is no longer what it was.
  [[nodiscard]] Result<void> check_same(const FoundDevice& opened);
  void note_open(const bus::DeviceAddress& address, std::weak_ptr<const SharedDevice> shared);

  BusSettings settings_;
  std::shared_ptr<UdevScan> scan_;
  DeviceWatch watch_;
  KernelCalls calls_;
  HidHost hids_;
  std::mutex open_list_;  // of:
  std::map<bus::DeviceAddress, std::weak_ptr<const SharedDevice>> open_;
};

}  // namespace thimble::linux
