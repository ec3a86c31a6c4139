#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/bus/hid_mailboxes.hpp"
#include "hal/linux/bus_settings.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/device_calls.hpp"
#include "hal/linux/hid_transfers.hpp"
#include "hal/linux/hiddev.hpp"
#include "hal/linux/realtime_thread.hpp"
#include "hal/linux/shared_device.hpp"
#include "hal/linux/wake_event.hpp"

namespace thimble::linux {

// Of one HID device: "/dev/hidraw0", and "/dev/usb/hiddev0" where the kernel makes one, else empty.
// What comes in is read from hidraw; what goes out leaves over hiddev where it takes plain bytes.
struct HidNodes {
  std::string hidraw;
  std::string hiddev;
};

// The threads of one opened HID device, and their mailboxes. One opens it, writes what is
// submitted and closes it: to open and to close last as long as the kernel lets any HID device's
// write to hidraw last, to write over hiddev as long as this device does.
// The other one reads meanwhile. Both have the settings' priority, and neither is RT.
//
// Thread: any non-RT one, one at a time; mail() as there, wake() from any.
// Ownership: settings, `opening` and `calls` must outlive it; the destructor waits for the kernel.
class HidConnection {
 public:
  // Begins to open `nodes`, of the device that `info` describes. `opening` is held while hidapi
  // opens, which does not take two at a time. Errors: of WakeEvent and RealtimeThread::start().
  [[nodiscard]] static Result<std::unique_ptr<HidConnection>> start(HidNodes nodes,
                                                                    const bus::BusDeviceInfo& info,
                                                                    const BusSettings& settings,
                                                                    std::mutex& opening,
                                                                    DeviceCalls& calls);
  ~HidConnection();
  HidConnection(const HidConnection&) = delete;
  HidConnection& operator=(const HidConnection&) = delete;

  // Whether the kernel has let it be opened, or refused it.
  [[nodiscard]] bool has_opened() const noexcept { return state_.load() != State::Opening; }
  // How the opening went; Timeout while it goes on after `patience`. Errors: of
  // HidTransfers::open(), open_hidraw_to_share(), share_node() and, for the thread that reads,
  // RealtimeThread::start(); Permission or System of a hiddev node that is there, cannot be opened,
  // and is wanted. Where there is none, the reports have numbers, or it takes no plain bytes,
  // everything goes over hidraw.
  [[nodiscard]] Result<void> opened(Duration patience);
  [[nodiscard]] bus::HidMailboxes& mail() noexcept { return mail_; }
  // Once opened: by which its reports leave. Expires when it closes.
  [[nodiscard]] std::weak_ptr<const SharedDevice> shared() const noexcept { return shared_; }
  // Something was submitted.
  THIMBLE_RT_IO void wake() noexcept { wake_->signal(); }
  // What was submitted and waits is still written, once, and then it closes.
  void end() noexcept;
  // Whether it has closed, after `patience` at the latest.
  [[nodiscard]] bool has_ended(Duration patience);
  [[nodiscard]] const bus::DeviceAddress& address() const noexcept { return address_; }

 private:
  enum class State : std::uint8_t { Opening, Open, Refused, Closed };

  HidConnection(HidNodes nodes, const bus::BusDeviceInfo& info, const BusSettings& settings,
                std::mutex& opening, DeviceCalls& calls);
  [[nodiscard]] Result<void> start();
  void run() noexcept;
  [[nodiscard]] Result<void> open();
  [[nodiscard]] Result<void> open_hiddev_node();
  [[nodiscard]] bool wants_hiddev() const noexcept;
  [[nodiscard]] std::optional<HiddevOutput> hiddev_output();
  void send() noexcept;
  [[nodiscard]] Result<void> open_for_guard(bool has_hiddev);
  void close() noexcept;
  void read() noexcept;
  void reach(State state) noexcept;
  [[nodiscard]] bool has_reached(State state, Duration patience);

  HidNodes nodes_;
  bus::DeviceAddress address_;
  bool has_report_ids_;
  std::size_t output_report_bytes_;
  const BusSettings* settings_;
  std::mutex* opening_;
  DeviceCalls* calls_;
  bus::HidMailboxes mail_;
  std::unique_ptr<WakeEvent> wake_;
  std::unique_ptr<WakeEvent> changed_;
  std::atomic<State> state_{State::Opening};
  std::atomic<bool> is_over_{false};
  Error refusal_;  // once Refused
  // Of the thread that writes. The kernel sleeps 50 ms when a HID device on USB is opened first
  // (usbhid_open(), Linux 6.1), and stops its transfers when it is closed last; within hidraw that
  // would be behind the lock for which all writes to hidraw wait, of strangers and of arms that
  // have no hiddev. So hiddev, which has no such lock, is the first and the last
  // (docs/decisions/0358).
  Descriptor hiddev_;
  std::shared_ptr<const SharedDevice> shared_;
  std::unique_ptr<HidTransfers> transfers_;
  std::unique_ptr<RealtimeThread> reader_;

  std::unique_ptr<RealtimeThread> thread_;  // last: it uses all of the above
};

}  // namespace thimble::linux
