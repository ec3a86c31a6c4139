#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/bus/serial_mailboxes.hpp"
#include "hal/linux/bus_settings.hpp"
#include "hal/linux/event_fd.hpp"
#include "hal/linux/realtime_thread.hpp"
#include "hal/linux/serial_transfers.hpp"
#include "hal/linux/shared_device.hpp"

namespace thimble::linux {

// A serial port of this machine, with a bus I/O thread of its own that owns the node.
//
// Thread, RT: as bus::SerialPort: submit() writes to one eventfd, read() makes no system call.
// Ownership: as SerialTransfers; closing joins the thread, which sends the newest of what was
// submitted first: see SerialTransfers::send_last().
// Errors: as bus::SerialPort and SerialTransfers::open(); those of RealtimeThread::start().
class SerialPort final : public bus::SerialMailboxes {
 public:
  // `node` is "/dev/ttyACM0" of the device at `address`.
  [[nodiscard]] static Result<std::unique_ptr<SerialPort>> open(const std::string& node,
                                                                const bus::DeviceAddress& address,
                                                                const bus::SerialLine& line,
                                                                const BusSettings& settings);
  ~SerialPort() override;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  THIMBLE_RT_IO IoStatus submit(std::span<const std::uint8_t> message) noexcept override;
  // The very node, for nobody else can open it; expires with this.
  [[nodiscard]] std::weak_ptr<const SharedDevice> shared() const noexcept { return shared_; }

 private:
  explicit SerialPort(std::unique_ptr<EventFd> wake) noexcept : wake_(std::move(wake)) {}
  void run() noexcept;

  KernelCalls calls_;
  std::shared_ptr<const SharedDevice> shared_;
  std::unique_ptr<EventFd> wake_;
  std::unique_ptr<SerialTransfers> transfers_;
  std::atomic<bool> is_over_{false};
  std::unique_ptr<RealtimeThread> thread_;
};

}  // namespace thimble::linux
