#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/plugin/sim_usb_model.hpp"

struct libusb_transfer;

namespace thimble::test {

// What a device's node leads to when a test links fake_libusb.cpp: the functions of libusb-1.0 that
// hal/linux uses, and behind them not a kernel but a model. It keeps libusb's and usbfs's rules and
// writes down every breach: a transfer submitted twice or left under way, one with a time-out, a
// halt cleared under a pending transfer or from within a callback, a read of less than a packet. A
// transfer of an OUT endpoint is cut into packets, kMostPacketsInFrame in each frame.
//
// Time is the test's: transfers move in run_frame() only. Thread: any; one lock guards all wires.
class FakeUsbWire {
 public:
  static constexpr int kMostPacketsInFrame = 19;  // of 64 bytes, bulk: USB 2.0, table 5-9

  explicit FakeUsbWire(std::unique_ptr<plugin::SimUsbModel> model);
  ~FakeUsbWire();
  FakeUsbWire(const FakeUsbWire&) = delete;
  FakeUsbWire& operator=(const FakeUsbWire&) = delete;

  // A descriptor that libusb_wrap_sys_device() takes for this device's node. The caller's to close.
  [[nodiscard]] int open_node();
  // Whoever opens this file, which is there already, has such a node, too.
  void attach(const std::string& path);
  // One millisecond: each pending transfer meets the device.
  void run_frame();
  // From now on whoever handles libusb's events passes a frame first: for what waits in the
  // product.
  void run_frames_by_events();
  // Those that are pending come back with NO_DEVICE, and so does everything later.
  void unplug();
  // The node alone says that the device is gone, as usbfs does when it hangs up: a transfer that
  // could tell, too, comes back when the kernel's drivers have let go.
  void hang_up();
  // The next reads end so: spoilt on the wire.
  void spoil_next_reads(int reads);
  // A driver of the kernel has the interface: who has not asked libusb to take it off is refused.
  void bind_kernel_driver() { is_kernel_driver_bound_ = true; }
  [[nodiscard]] bool is_kernel_driver_bound() const { return is_kernel_driver_bound_; }
  // The next submissions are refused with LIBUSB_ERROR_NO_MEM.
  void refuse_next_submissions(int submissions);

  [[nodiscard]] std::vector<std::string> breaches() const;
  // Contexts, handles, claims and transfers that exist, of all wires.
  [[nodiscard]] static int alive();
  [[nodiscard]] std::size_t pending() const;
  [[nodiscard]] int halts_cleared() const;
  // Transfers of OUT endpoints that were pending when a halt was cleared last.
  [[nodiscard]] std::size_t outputs_at_last_clearing() const;

 private:
  friend struct FakeLibusb;

  void serve(libusb_transfer& transfer);
  void serve_out(libusb_transfer& transfer);
  void end(libusb_transfer& transfer, int status, int actual_bytes);
  void breach(const char* what) { breaches_.emplace_back(what); }
  [[nodiscard]] bool is_pending(const libusb_transfer& transfer) const;

  std::unique_ptr<plugin::SimUsbModel> model_;
  bus::BusDeviceInfo info_;
  MonotonicTime now_{};
  int event_{-1};                          // readable while something has ended
  std::array<int, 2> device_{-1, -1};      // a pipe: its other end is there as the device is
  std::vector<libusb_transfer*> pending_;  // in the order of submission
  std::vector<libusb_transfer*> cancelled_;
  std::deque<libusb_transfer*> ended_;
  std::set<std::uint8_t> halted_;
  std::vector<std::string> breaches_;
  int reads_to_spoil_{0};
  int submissions_to_refuse_{0};
  int halts_cleared_{0};
  std::size_t outputs_at_last_clearing_{0};
  bool is_run_by_events_{false};
  bool is_claimed_{false};
  bool is_kernel_driver_bound_{false};
  bool is_gone_{false};
};

}  // namespace thimble::test
