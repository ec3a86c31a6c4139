#pragma once

#include <atomic>
#include <memory>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/bus/usb_mailboxes.hpp"
#include "hal/linux/event_fd.hpp"
#include "hal/linux/realtime_thread.hpp"
#include "hal/linux/shared_device.hpp"
#include "hal/linux/usb_transfers.hpp"

namespace thimble::linux {

// A USB device of this machine, with a bus I/O thread of its own that does whatever may block.
//
// Thread, RT: as bus::UsbDevice: submit() and start_control() write to one eventfd, read() and
// read_control() make no system call. Ownership: as UsbTransfers; closing joins the thread, which
// sends the newest of what was submitted first: see UsbTransfers::send_last().
// Errors: as bus::UsbDevice and UsbTransfers::open(); those of RealtimeThread::start().
class UsbDevice final : public bus::UsbMailboxes {
 public:
  // `node` is the opened node of the device that `info` describes, and is closed in every case.
  // The clock stamps what arrives.
  [[nodiscard]] static Result<std::unique_ptr<UsbDevice>> open(
      int node, const bus::BusDeviceInfo& info, const bus::UsbClaim& claim, const Clock& clock,
      const RealtimeThreadSettings& thread, const RealtimeReport& process);
  ~UsbDevice() override;

  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;

  // With the same claim, which belongs to what is open and not to its number; expires with this.
  [[nodiscard]] std::weak_ptr<const SharedDevice> shared() const noexcept { return shared_; }

  THIMBLE_RT_IO IoStatus submit(std::uint8_t endpoint,
                                std::span<const std::uint8_t> packet) noexcept override;
  THIMBLE_RT_IO IoStatus start_control(const bus::UsbControlRequest& request) noexcept override;

 private:
  UsbDevice(std::span<const bus::UsbOpenPipe> pipes, std::unique_ptr<EventFd> wake);
  void run() noexcept;

  std::shared_ptr<const SharedDevice> shared_;
  std::unique_ptr<EventFd> wake_;
  std::unique_ptr<UsbTransfers> transfers_;
  std::atomic<bool> is_over_{false};
  std::unique_ptr<RealtimeThread> thread_;
};

}  // namespace thimble::linux
